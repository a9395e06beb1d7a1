#include "app/torch_part.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "common/error.h"
#include "common/text.h"

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// Both of its streams: LibTorch may warn before it answers, and says there why it does not start.
std::string output_of(const std::string& command, int& code) {
  std::string text;
  code = -1;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return "cannot be started";
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
    text.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) code = WEXITSTATUS(status);
  return text;
}

// The last line that is not empty, or that begins with `first`.
std::string last_line(const std::string& text, const std::string& first = "") {
  std::string found;
  for (const std::string& line : split(text, '\n'))
    if (!line.empty() && line.rfind(first, 0) == 0) found = line;
  return found;
}

}  // namespace

fs::path torch_part_path() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path() / "mocaplm-torch";
}

void prepare_for_torch() {
  // OpenMP's threads wait for work by spinning for milliseconds, which costs everything when
  // another program has a core: let them spin for tens of microseconds.
  if (std::getenv("OMP_WAIT_POLICY") == nullptr) ::setenv("GOMP_SPINCOUNT", "20000", 0);
}

TorchAnswer ask_torch_part(const std::string& arguments) {
  TorchAnswer answer;
  const std::string path = torch_part_path().string();
  answer.installed = fs::exists(path);
  if (!answer.installed) {
    answer.failure = path + " is not there";
    return answer;
  }
  prepare_for_torch();
  int code = 0;
  const std::string text = output_of(quoted(path) + " " + arguments, code);
  const std::string object = last_line(text, "{"), list = last_line(text, "[{");
  if (code != 0 || (object.empty() && list.empty())) {
    answer.failure = path + " does not work: " +
                     (text.empty() ? "exit code " + std::to_string(code) : last_line(text));
    return answer;
  }
  answer.json = parse_json(object.empty() ? list : object, path);
  return answer;
}

}  // namespace mocaplm
