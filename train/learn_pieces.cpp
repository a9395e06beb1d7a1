#include "train/learn_pieces.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "common/error.h"
#include "common/files.h"
#include "common/temporary_folder.h"

extern char** environ;

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

// Runs a program to its end, what it writes into `output`; returns its exit code, -1 for a signal.
int run(const std::vector<std::string>& words, const fs::path& output) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int error =
      ::posix_spawn(&child, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw Error(ExitCode::internal,
                "cannot start " + words[0] + ", which learns pieces: " + std::strerror(error));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// What the program said at its end: "mocaplm: MESSAGE".
std::string last_message(const fs::path& output) {
  const std::string text = read_file(output), name = "mocaplm: ";
  const std::size_t at = text.rfind(name);
  if (at == std::string::npos) return "learning pieces failed";
  return text.substr(at + name.size(), text.find('\n', at) - at - name.size());
}

}  // namespace

std::string learn_model_pieces(const PieceConfig& config, const Tokenizer& tokenizer,
                               const fs::path& data, const fs::path& program) {
  const TemporaryFolder scratch;
  tokenizer.save(scratch / "tokenizer.json");
  const fs::path mocaplm =
      program.empty() ? fs::read_symlink("/proc/self/exe").parent_path() / "mocaplm" : program;
  const int code = run({mocaplm.string(), "tokenize", fs::absolute(data).string(), "--tokenizer",
                        (scratch / "tokenizer.json").string(), "--out",
                        (scratch / "learnt").string(), config.bpe > 0 ? "--bpe" : "--unigram",
                        std::to_string(std::max(config.bpe, config.unigram))},
                       scratch / "output");
  const std::string said = code == 0 ? "" : last_message(scratch / "output");
  if (code == static_cast<int>(ExitCode::usage)) throw UsageError("pieces: " + said);
  if (code == static_cast<int>(ExitCode::data)) throw DataError(in_file("pieces"), said);
  if (code != 0) throw Error(ExitCode::internal, "pieces: " + said);
  return read_file(scratch / "learnt" / "pieces.model");
}

}  // namespace mocaplm
