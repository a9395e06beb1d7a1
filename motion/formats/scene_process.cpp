#include "motion/formats/scene_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <thread>

#include "common/error.h"
#include "common/find_program.h"
#include "common/text.h"

extern char** environ;

namespace fs = std::filesystem;

namespace mocaplm {

namespace {

constexpr const char* kProgram = "mocaplm-scene";
constexpr std::size_t kMaxComplaint = 4096;
const std::string kGaveUp = "the reader of such files gave up: ";

// Both ends of a pipe that programs started meanwhile by other threads do not inherit.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_, O_CLOEXEC) != 0) throw DataError(in_file("pipe"), std::strerror(errno));
  }
  ~Pipe() {
    close(0);
    close(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int reading() const { return ends_[0]; }
  int writing() const { return ends_[1]; }
  void close(int end) {
    if (ends_[end] >= 0) ::close(ends_[end]);
    ends_[end] = -1;
  }

 private:
  int ends_[2] = {-1, -1};
};

// The program while it runs; whatever happens here, it does not outlive this.
class Child {
 public:
  // `mode`: an argument behind the file; null for none.
  Child(const fs::path& program, const fs::path& file, const char* mode, Pipe& answer,
        Pipe& complaint) {
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&actions, answer.writing(), 1);
    ::posix_spawn_file_actions_adddup2(&actions, complaint.writing(), 2);
    std::string name = program.string(), argument = fs::absolute(file).string();
    std::array<char*, 4> arguments = {name.data(), argument.data(), const_cast<char*>(mode),
                                      nullptr};
    const int error =
        ::posix_spawn(&pid_, name.c_str(), &actions, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    answer.close(1);
    complaint.close(1);
    if (error != 0)
      throw DataError(in_file(file.string()),
                      "its reader " + name + " cannot be started: " + std::strerror(error));
  }
  ~Child() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  // Its status once it has ended; nothing while it runs.
  std::optional<int> ended() {
    int status = 0;
    const pid_t pid = ::waitpid(pid_, &status, WNOHANG);
    if (pid == 0 || (pid < 0 && errno == EINTR)) return std::nullopt;
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_ = -1;
};

// Appends what is there to read; false at the end.
bool take_some(int from, std::string& to, std::uintmax_t most) {
  std::array<char, 1 << 16> buffer;
  const ssize_t n = ::read(from, buffer.data(), buffer.size());
  if (n < 0) return errno == EINTR || errno == EAGAIN;
  const std::uintmax_t room = most > to.size() ? most - to.size() : 0;
  to.append(buffer.data(), static_cast<std::size_t>(
                               std::min<std::uintmax_t>(room, static_cast<std::uintmax_t>(n))));
  return n > 0;
}

class Deadline {
 public:
  Deadline(std::chrono::milliseconds patience, const std::string& file)
      : patience_(patience), end_(Clock::now() + patience), file_(file) {}
  // Milliseconds, at least 1. Throws DataError when there are none.
  int left() const {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end_ - Clock::now());
    if (left.count() <= 0)
      throw DataError(in_file(file_),
                      kGaveUp + "it was not done after " +
                          format_number(static_cast<double>(patience_.count()) / 1000) +
                          " seconds");
    return static_cast<int>(left.count());
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::chrono::milliseconds patience_;
  Clock::time_point end_;
  const std::string& file_;
};

// The program's last words on one line, printable.
std::string one_line(const std::string& text) {
  std::string line;
  for (const char c : text)
    line += c == '\n' ? ' ' : static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
  const std::size_t begin = line.find_first_not_of(' '), end = line.find_last_not_of(" .");
  return begin == line.npos ? "" : line.substr(begin, end - begin + 1);
}

std::string end_of(int status, const std::string& complaint) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == static_cast<int>(ExitCode::data) &&
      !complaint.empty())
    return complaint;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    return kGaveUp + "it needed too much time";
  if (WIFSIGNALED(status))
    return kGaveUp + "it crashed (" + ::strsignal(WTERMSIG(status)) +
           "); the file is damaged or needs too much memory";
  return kGaveUp +
         (complaint.empty() ? "exit code " + std::to_string(WEXITSTATUS(status)) : complaint);
}

// What the program says of a file.
std::string answer_of(const fs::path& path, const SceneReader& reader, const char* mode);

}  // namespace

fs::path find_scene_reader() {
  if (const char* given = std::getenv("MOCAPLM_SCENE")) return given;
  std::error_code error;
  const fs::path beside = fs::read_symlink("/proc/self/exe", error).parent_path() / kProgram;
  if (fs::exists(beside, error)) return beside;
  return find_program(kProgram);
}

Scene read_scene(const fs::path& path, const SceneReader& reader) {
  return parse_scene(answer_of(path, reader, nullptr), path.string());
}

std::string read_character_glb(const fs::path& path, const SceneReader& reader) {
  return answer_of(path, reader, "--glb");
}

namespace {

std::string answer_of(const fs::path& path, const SceneReader& reader, const char* mode) {
  const std::string file = path.string();
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw DataError(in_file(file), "cannot be read: " + error.message());
  if (size > reader.max_file)
    throw DataError(in_file(file), "has " + std::to_string(size >> 20) + " MiB, more than the " +
                                       std::to_string(reader.max_file >> 20) +
                                       " MiB of a scene file; export it without meshes and "
                                       "textures");
  const fs::path program = reader.program.empty() ? find_scene_reader() : reader.program;
  if (program.empty() || !fs::exists(program, error))
    throw DataError(in_file(file), "is read by the program mocaplm-scene, which is not there" +
                                       (program.empty() ? "" : " (" + program.string() + ")") +
                                       ": install it beside mocaplm, or name it in the "
                                       "environment's MOCAPLM_SCENE");
  const Deadline deadline(reader.patience, file);
  Pipe answer, complaint;
  Child child(program, path, mode, answer, complaint);
  std::string bytes, words;
  std::array<pollfd, 2> waiting = {pollfd{answer.reading(), POLLIN, 0},
                                   pollfd{complaint.reading(), POLLIN, 0}};
  while (waiting[0].fd >= 0 || waiting[1].fd >= 0) {
    waiting[0].revents = waiting[1].revents = 0;
    if (::poll(waiting.data(), waiting.size(), deadline.left()) < 0 && errno != EINTR)
      throw DataError(in_file(file), std::strerror(errno));
    if (waiting[0].revents != 0 && !take_some(answer.reading(), bytes, reader.max_answer + 1))
      waiting[0].fd = -1;
    if (waiting[1].revents != 0 && !take_some(complaint.reading(), words, kMaxComplaint))
      waiting[1].fd = -1;
    if (bytes.size() > reader.max_answer)
      throw DataError(in_file(file), "holds more than " + std::to_string(reader.max_answer >> 20) +
                                         " MiB of motion; split it");
  }
  // Its streams are closed, so it is about to end: or it only pretends.
  std::optional<int> ended;
  while (!(ended = child.ended())) {
    deadline.left();
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  const int status = *ended;
  if (status != 0) throw DataError(in_file(file), end_of(status, one_line(words)));
  return bytes;
}

}  // namespace

}  // namespace mocaplm
