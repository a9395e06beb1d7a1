// The parts of describe_path, each for some kinds of files. All throw DataError where a file is not
// sound.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/table.h"
#include "motion/clip_range.h"

namespace mocaplm {

// "3: a, b, c", of more than 24 the first; "none".
std::string value_text(std::vector<std::string> values);
// The value of a key of an object, or 0 and "" where it is none such.
double number_of(const Json& json, const char* key);
std::string text_of(const Json& json, const char* key);

// Motions of a file: length, figure, how it stands, what is remarkable. In described_motion.cpp.
std::vector<Table> describe_motion(const std::filesystem::path& file,
                                   const ReadOptions& options = {}, const ClipRange& range = {});

// Models, training runs and experiments; their folders.
std::vector<Table> describe_model(const std::filesystem::path& folder);
bool is_run(const std::filesystem::path& folder);
std::vector<Table> describe_run(const std::filesystem::path& folder);
bool is_experiment(const std::filesystem::path& folder);
std::vector<Table> describe_experiment(const std::filesystem::path& folder);
std::vector<Table> describe_safetensors(const std::filesystem::path& file);
std::vector<Table> describe_pieces(const std::filesystem::path& file);

// JSON that no reader of the libraries takes: told by its keys.
std::vector<Table> describe_json(const std::filesystem::path& file, const Json& json);

// Motion files below a folder that is nothing else, by their endings; nothing where there are none.
std::vector<Table> describe_recordings(const std::filesystem::path& folder);

// Pages, pictures, texts, tables, indexes, by their endings.
std::vector<Table> describe_page(const std::filesystem::path& file);
std::vector<Table> describe_picture(const std::filesystem::path& file);
std::vector<Table> describe_corpus(const std::filesystem::path& file);
std::vector<Table> describe_csv(const std::filesystem::path& file);
std::vector<Table> describe_lines(const std::filesystem::path& file);
std::vector<Table> describe_index(const std::filesystem::path& file);

// What convert (.glb, .vrma) and render (.png, .gif, .mp4) write.
std::vector<Table> describe_glb(const std::filesystem::path& file);
std::vector<Table> describe_film(const std::filesystem::path& file);

}  // namespace mocaplm
