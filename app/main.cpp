// mocaplm: motion capture as a language. This file only names the commands.
#include <memory>

#include "app/commands.h"
#include "app/help.h"
#include "app/run.h"

int main(int argc, char** argv) {
  using namespace mocaplm;
  CLI::App app(
      "mocaplm learns motion capture as a language and generates dances from it: a frame is a "
      "word, a joint angle a character.",
      "mocaplm");
  // Commands take both over when they are added.
  app.formatter(std::make_shared<HelpPages>());
  app.set_help_flag("-h,--help", "print this and exit");
#ifdef MOCAPLM_WITH_TORCH
  add_train(app);
  add_classify(app);
  add_evaluate(app);
  add_experiment(app);
  add_infill(app);
  add_interpolate(app);
  add_demo(app);
  add_torch_commands(app);
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
  add_doctor(app);
  add_completion(app);
  add_man_page(app);
#endif
  return run(app, argc, argv);
}
