// What to tell a user whose command line cannot be parsed.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace mocaplm {

// Names the nearest command or option where one is not known, or what an option takes where its
// value is none, and the command whose help tells more. `app` has tried to parse the words.
std::string parse_failure(const CLI::App& app, int argc, char** argv, const CLI::ParseError& error);

}  // namespace mocaplm
