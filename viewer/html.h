// Text that goes into a page: escaping, JSON inside <script>, base64, and filling a template.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/json.h"
#include "common/table.h"

namespace mocaplm {

// For element content and quoted attributes: & < > " ' are escaped, control characters dropped.
std::string escape_html(std::string_view text);

// JSON that may stand inside <script>: "<" and ">" are written as \u003c and \u003e, so no text can
// close the element; bytes that are not UTF-8 become U+FFFD.
std::string script_json(const Json& json);

// RFC 4648, with padding.
std::string base64(const std::vector<std::uint8_t>& bytes);

// Replaces every {{name}} by its value in one pass: a value is never searched itself. Throws Error
// when the template names a value that is not given.
std::string fill_template(std::string_view text, const std::map<std::string, std::string>& values);

// <figure> with the table, its title as caption and its notes. Columns of numbers, also such as
// "12.5 %", are right-aligned, the first one and others of text left-aligned.
std::string html_table(const Table& table);

// As escape_html; the line may break after each of _ and /, as in names of clips and files.
std::string escape_name(std::string_view text);

}  // namespace mocaplm
