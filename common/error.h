// Errors for people: what is wrong, where it is, what was expected, what to do.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace mocaplm {

enum class ExitCode { ok = 0, internal = 1, usage = 2, data = 3 };

// The base of every error this program raises on purpose; `what()` is a whole sentence for the
// user.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

// The command line or a setting asks for something that cannot be: exit code 2.
class UsageError : public Error {
 public:
  explicit UsageError(const std::string& message) : Error(ExitCode::usage, message) {}
};

// A place inside a file: "walk.bvh: line 12". An empty `where` names the file alone.
struct Place {
  std::string file;
  std::string where;
};

Place in_file(const std::string& file);
Place at_byte(const std::string& file, std::size_t byte);
Place at_line(const std::string& file, std::size_t line);
Place at_frame(const std::string& file, std::size_t frame);
Place at_joint(const std::string& file, std::size_t frame, const std::string& joint);
std::string to_string(const Place& place);

// A file or its contents are not what they must be: exit code 3.
class DataError : public Error {
 public:
  DataError(const Place& place, const std::string& message)
      : Error(ExitCode::data, to_string(place) + ": " + message) {}
};

}  // namespace mocaplm
