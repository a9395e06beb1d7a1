// What `generate` and `demo` write and print of a generated dance.
#pragma once

#include <string>
#include <vector>

#include "common/table.h"
#include "generate/generator.h"
#include "viewer/page.h"

namespace mocaplm {

// {"genre=waack", ...} -> labels. Throws UsageError for a text without "=".
Labels parse_labels(const std::vector<std::string>& texts);

// STEM.npz, STEM.bvh and STEM.html; STEM may end in one of these, .glb or .csv to get only that
// file.
std::vector<std::string> generated_files(const std::string& stem);

// Writes these files; the page plays the prompt beside the dance.
void write_generated(const std::string& stem, const Generator& generator,
                     const GenerateRequest& request, const GenerateResult& result,
                     const std::string& model, const std::string& prompt);

// The prompt beside the dance, with the settings that made it.
Page generated_page(const Generator& generator, const GenerateRequest& request,
                    const GenerateResult& result, const std::string& model,
                    const std::string& prompt);

// Length, conditions, share of frozen frames beside the prompt's own, files.
Table generated_table(const Generator& generator, const GenerateRequest& request,
                      const GenerateResult& result, const std::string& stem);

}  // namespace mocaplm
