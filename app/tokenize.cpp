// mocaplm tokenize: fit a tokenizer, say what it loses, write motion as text and read it back.
#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "common/error.h"
#include "tokenizer/tokenize.h"

namespace mocaplm {

namespace {

struct TokenizeCommand {
  TokenizeOptions options;
  std::string decode, json;
};

void refuse_settings(const CLI::App& app, const std::string& beside) {
  const Json settings = settings_json(TokenizerConfig());
  for (const auto& item : settings.items())
    if (app.get_option(option_flag(item.key()))->count() > 0)
      throw UsageError(option_flag(item.key()) + " cannot be combined with " + beside +
                       ", which fixes it");
}

void run_tokenize(const CLI::App& app, const TokenizeCommand& command) {
  const TokenizeOptions& options = command.options;
  if (!options.tokenizer.empty()) refuse_settings(app, "--tokenizer");
  if (command.decode.empty()) {
    if (options.inputs.empty())
      throw UsageError("give a dataset folder or motion files, or --decode with a corpus");
    print_table(tokenize(options), command.json);
    return;
  }
  if (!options.inputs.empty() || options.text)
    throw UsageError("--decode takes neither clips nor --text");
  if (options.tokenizer.empty())
    throw UsageError("--decode needs --tokenizer, the tokenizer.json that wrote the text");
  print_table(untokenize(command.decode, options.tokenizer, options.out), command.json);
}

}  // namespace

void add_tokenize(CLI::App& app) {
  CLI::App* tokenize =
      app.add_subcommand("tokenize", "fit a tokenizer, write motion as text, or decode text");
  auto command = std::make_shared<TokenizeCommand>();
  TokenizeOptions& options = command->options;
  tokenize->add_option("INPUT", options.inputs,
                       "dataset folders or motion files (.npz, .pkl, .bvh)");
  tokenize
      ->add_option(
          "--out", options.out,
          "folder for tokenizer.json and the text, or a .json file; with --decode for the clips")
      ->required();
  tokenize->add_option("--tokenizer", options.tokenizer,
                       "use this tokenizer.json instead of fitting one");
  tokenize->add_flag("--text", options.text,
                     "write corpus.txt, one clip a line, a character a value");
  tokenize->add_option("--decode", command->decode,
                       "bring the clips of this corpus.txt back as .npz");
  tokenize->add_option("--json", command->json, "write the table as JSON, too");
  bind_options(*tokenize, options.config);
  tokenize->callback([tokenize, command] { run_tokenize(*tokenize, *command); });
}

}  // namespace mocaplm
