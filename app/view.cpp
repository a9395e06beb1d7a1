// mocaplm view: one self-contained page that plays motions side by side.
#include <cstdio>
#include <memory>

#include "app/commands.h"
#include "app/options.h"
#include "app/read_options.h"
#include "common/text.h"
#include "viewer/open.h"

namespace mocaplm {

namespace {

struct ViewCommand {
  ViewOptions options;
  std::string out;
};

void run_view(ViewCommand& command) {
  check_page_path(command.out);
  std::vector<std::string> remarks;
  const Page page = open_page(command.options, &remarks);
  write_page(command.out, page);
  for (const std::string& remark : remarks) std::printf("%s\n", remark.c_str());
  std::printf(
      "%s: %zu motion%s, %s MB; open it in a browser\n", command.out.c_str(), page.motions.size(),
      page.motions.size() == 1 ? "" : "s",
      format_fixed(static_cast<double>(std::filesystem::file_size(command.out)) / 1e6, 1).c_str());
}

}  // namespace

void add_view(CLI::App& app) {
  CLI::App* view =
      app.add_subcommand("view", "write a page that plays clips side by side in a browser");
  auto command = std::make_shared<ViewCommand>();
  ViewOptions& options = command->options;
  view->add_option("CLIP", options.inputs, kMotionFiles + std::string("or dataset folders"))
      ->required();
  view->add_option("--out", command->out, "the page, a .html file")->required();
  view->add_option("--clip", options.clips, "show these clips of the dataset folders")
      ->type_name("NAME")
      ->delimiter(',');
  view->add_option("--title", options.title, "the page's title (default: the clips' names)");
  view->add_option("--note", options.note, "a few words beside the title");
  view->add_option("--joints", options.joints,
                   "joints or groups in a colour of their own, e.g. right_arm")
      ->delimiter(',');
  view->add_option("--trails", options.trails,
                   "joints that draw their path (default: wrists, off at first)")
      ->delimiter(',');
  add_read_options(*view, options.read, {"--source-fps,--fps"});
  view->callback([command] { run_view(*command); });
}

}  // namespace mocaplm
