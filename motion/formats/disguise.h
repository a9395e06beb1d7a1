// Files that are not the motion their name promises, though nobody renamed them: what a clone or a
// download left in its place.
#pragma once

#include <filesystem>
#include <string>

namespace mocaplm {

// Throws DataError saying what the file is and what to do where its first bytes (some hundred) are
// a Git LFS pointer, a web page, a server's error, a packed archive, or text in UTF-16.
void refuse_disguised(const std::string& head, const std::filesystem::path& path);

}  // namespace mocaplm
