// mocaplm: motion capture as a language. This file only names the commands.
#include <cstdio>
#include <exception>

#include "app/commands.h"
#include "app/run.h"

int main(int argc, char** argv) {
  using namespace mocaplm;
  CLI::App app("mocaplm learns motion capture as a language and generates dances from it",
               "mocaplm");
#ifdef MOCAPLM_WITH_TORCH
  add_train(app);
  add_classify(app);
  add_evaluate(app);
  add_experiment(app);
  add_infill(app);
  add_interpolate(app);
  add_demo(app);
#else
  add_synth(app);
  add_import(app);
  add_info(app);
  add_tokenize(app);
  add_commands_with_torch(app);
  add_evaluate(app);
  add_generate(app);
  add_view(app);
  add_convert(app);
  add_render(app);
  add_gesture(app);
  add_query(app);
  add_filter(app);
  add_emulate(app);
#endif
  return run(app, argc, argv);
}
