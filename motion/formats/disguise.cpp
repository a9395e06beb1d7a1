#include "motion/formats/disguise.h"

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

// Without a byte order mark and blanks before it, in lower case.
std::string plain_text(const std::string& head) {
  const std::size_t bom = starts_with(head, "\xEF\xBB\xBF") ? 3 : 0;
  const std::size_t first = head.find_first_not_of(" \t\r\n", bom);
  return first == std::string::npos ? "" : lower(head.substr(first));
}

// The name of a zip archive's first entry, as much of it as is there.
std::string first_entry(const std::string& head) {
  if (head.size() < 30) return "";
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(head[i]); };
  return head.substr(30, byte(26) + 256u * byte(27));
}

std::string what_it_is(const std::string& head, const std::string& extension) {
  const std::string text = plain_text(head);
  if (starts_with(text, "version https://git-lfs.github.com/spec/"))
    return "is a Git LFS pointer, not the file itself: run git lfs pull in the repository it came "
           "from (or download the file from its web page)";
  if (starts_with(text, "<!doctype html") || starts_with(text, "<html"))
    return "is a web page (HTML), saved in place of the file: download the file itself (on GitHub "
           "by \"Raw\")";
  const bool xml_is_right = extension == ".dae";
  if (starts_with(text, "<?xml") && !xml_is_right)
    return text.find("<error>") != std::string::npos
               ? "is a server's error message (XML), saved in place of the file: download it again"
               : "is an XML text, not motion";
  if (starts_with(text, "404: not found") || starts_with(text, "{\"message\""))
    return "is a server's error message, saved in place of the file: download it again";
  if (starts_with(head, "PK\3\4")) {
    const std::string entry = first_entry(head);
    // NumPy's and PyTorch's archives are meant to be such; all others were packed by somebody.
    const bool meant = extension == ".npz" || extension == ".pt" || extension == ".pth";
    if (!entry.empty() && !ends_with(lower(entry), ".npy") && !meant)
      return "is a zip archive (its first entry: " + entry + "): unpack it";
  }
  for (const auto& [magic, name] :
       {std::pair<std::string, std::string>{"\x1f\x8b", "is packed by gzip"},
        {"\xFD"
         "7zXZ",
         "is packed by xz"},
        {"BZh", "is packed by bzip2"},
        {"7z\xBC\xAF", "is a 7z archive"},
        {"Rar!", "is a RAR archive"}})
    // joblib packs its pickles itself.
    if (starts_with(head, magic) && extension != ".pkl") return name + ": unpack it";
  if (extension == ".bvh" && (starts_with(head, "\xFF\xFE") || starts_with(head, "\xFE\xFF")))
    return "is text in UTF-16: save it as plain text (UTF-8)";
  return "";
}

}  // namespace

void refuse_disguised(const std::string& head, const std::filesystem::path& path) {
  const std::string what = what_it_is(head, lower(path.extension().string()));
  if (!what.empty()) throw DataError(in_file(path.string()), what);
}

}  // namespace mocaplm
