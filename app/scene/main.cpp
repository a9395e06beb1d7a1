// mocaplm-scene FILE: a scene file as bytes (motion/formats/scene.h) on the standard output.
// mocaplm-scene FILE --glb: the character of an .fbx as a .glb.
// Started by read_scene for each file, so that a hostile one has little to take: 2 GiB of memory, a
// minute of a processor, no file but its own and those beside a .gltf. Exit code 3 and a sentence
// on the standard error for what is refused.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <new>
#include <string>

#include "app/scene/assimp_scene.h"
#include "app/scene/character_glb.h"
#include "common/error.h"

namespace {

void limit(int what, rlim_t most, rlim_t at_last = 0) {
  const struct rlimit both = {most, std::max(most, at_last)};
  ::setrlimit(static_cast<__rlimit_resource>(what), &both);
}

void set_limits() {
  limit(RLIMIT_AS, rlim_t{2} << 30);
  limit(RLIMIT_CPU, 60, 61);  // the first says SIGXCPU, the second kills
  limit(RLIMIT_CORE, 0);
}

bool write_all(const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = ::write(1, bytes.data() + at, bytes.size() - at);
    if (n <= 0) return false;
    at += static_cast<std::size_t>(n);
  }
  return true;
}

int refuse(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  return static_cast<int>(mocaplm::ExitCode::data);
}

}  // namespace

int main(int count, char** arguments) {
  const bool glb = count == 3 && std::string(arguments[2]) == "--glb";
  if (count != 2 && !glb) {
    std::fprintf(stderr, "usage: mocaplm-scene FILE [--glb] (started by mocaplm)\n");
    return static_cast<int>(mocaplm::ExitCode::usage);
  }
  set_limits();
  const std::string file = arguments[1];
  try {
    return write_all(glb ? mocaplm::character_glb(file)
                         : scene_bytes(mocaplm::read_with_assimp(file)))
               ? 0
               : 1;
  } catch (const mocaplm::DataError& error) {
    // The one who asked names the file in its own way.
    const std::string text = error.what(), place = file + ": ";
    return refuse(text.rfind(place, 0) == 0 ? text.substr(place.size()) : text);
  } catch (const std::bad_alloc&) {
    return refuse("needs more than 2 GiB of memory");
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}
