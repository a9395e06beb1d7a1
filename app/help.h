// The pages of --help, 80 columns wide: the general one tells the walk and the commands by groups,
// a command's its options with their limits, and two examples.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace mocaplm {

class HelpPages : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;
};

}  // namespace mocaplm
