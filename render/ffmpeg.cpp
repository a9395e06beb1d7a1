#include "render/ffmpeg.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include "common/error.h"
#include "common/find_program.h"
#include "common/text.h"

namespace mocaplm {

namespace {

constexpr int kNoProgram = 127;  // how a child ends that could not become the program

// An unnamed file for what the program complains about.
int temporary_file() {
  std::string name = (std::filesystem::temp_directory_path() / "mocaplm-ffmpeg-XXXXXX").string();
  const int file = ::mkostemp(name.data(), O_CLOEXEC);
  if (file >= 0) ::unlink(name.c_str());
  return file;
}

// The last 500 bytes.
std::string read_end(int file) {
  const off_t size = ::lseek(file, 0, SEEK_END);
  if (size <= 0) return "";
  std::string text(static_cast<std::size_t>(std::min<off_t>(size, 500)), '\0');
  const ssize_t count =
      ::pread(file, text.data(), text.size(), size - static_cast<off_t>(text.size()));
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text;
}

}  // namespace

std::string find_ffmpeg() {
  if (const char* given = std::getenv("MOCAPLM_FFMPEG")) return given;
  const std::filesystem::path found = find_program("ffmpeg");
  if (!found.empty()) return found.string();
  throw UsageError(
      ".mp4 and .gif are made by the program ffmpeg, which is not here: apt-get install ffmpeg, or "
      "name it in MOCAPLM_FFMPEG (a .png needs nothing else)");
}

Ffmpeg::Ffmpeg(const std::string& program, int width, int height, double fps,
               const std::vector<std::string>& output)
    : program_(program) {
  std::vector<std::string> words = {program,
                                    "-y",
                                    "-nostdin",
                                    "-loglevel",
                                    "error",
                                    "-f",
                                    "rawvideo",
                                    "-pixel_format",
                                    "rgb24",
                                    "-video_size",
                                    std::to_string(width) + "x" + std::to_string(height),
                                    "-framerate",
                                    format_number(fps),
                                    "-i",
                                    "pipe:0"};
  words.insert(words.end(), output.begin(), output.end());
  // Prepared here: between fork and exec nothing may allocate.
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  int pipe[2];
  errors_ = temporary_file();
  if (errors_ < 0 || ::pipe2(pipe, O_CLOEXEC) != 0)
    throw DataError(in_file(program), "cannot be started: no temporary file or pipe");
  old_handler_ = ::signal(SIGPIPE, SIG_IGN);  // when it ends early, write() says so
  child_ = ::fork();
  if (child_ == 0) {
    ::dup2(pipe[0], 0);
    ::dup2(errors_, 1);
    ::dup2(errors_, 2);
    ::execv(program.c_str(), arguments.data());
    ::_exit(kNoProgram);
  }
  ::close(pipe[0]);
  to_ = pipe[1];
}

Ffmpeg::~Ffmpeg() {
  wait();
  ::close(errors_);
  ::signal(SIGPIPE, old_handler_);
}

int Ffmpeg::wait() {
  if (to_ >= 0) ::close(to_);
  to_ = -1;
  int status = -1;
  if (child_ > 0)
    while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) continue;
  child_ = -1;
  return status;
}

void Ffmpeg::write(const Picture& picture) {
  for (std::size_t at = 0; at < picture.rgb.size();) {
    const ssize_t wrote = ::write(to_, picture.rgb.data() + at, picture.rgb.size() - at);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) {
      finish();
      throw DataError(in_file(program_), "ended before the film did");
    }
    at += static_cast<std::size_t>(wrote);
  }
}

void Ffmpeg::finish() {
  const int status = wait();
  if (status == 0) return;
  const std::string said = read_end(errors_);
  if (!said.empty()) throw DataError(in_file(program_), "failed: " + said);
  if (WIFSIGNALED(status))
    throw DataError(in_file(program_), "was ended by signal " + std::to_string(WTERMSIG(status)));
  if (!WIFEXITED(status) || WEXITSTATUS(status) == kNoProgram)
    throw DataError(in_file(program_), "cannot be run");
  throw DataError(in_file(program_), "failed with exit code " +
                                         std::to_string(WEXITSTATUS(status)) + " and no message");
}

}  // namespace mocaplm
