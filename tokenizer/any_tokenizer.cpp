#include "tokenizer/any_tokenizer.h"

namespace mocaplm {

std::unique_ptr<AnyTokenizer> fit_tokenizer(const TokenizerConfig& frames, const TileConfig& tiles,
                                            std::size_t count,
                                            const std::function<Clip(std::size_t)>& clip) {
  if (tiles.tiles > 0)
    return std::make_unique<TileWords>(TileTokenizer::fit(frames, tiles, count, clip));
  return std::make_unique<FrameWords>(Tokenizer::fit(frames, count, clip));
}

std::unique_ptr<AnyTokenizer> load_tokenizer(const std::filesystem::path& path) {
  const Json json = load_json(path);
  const bool tiles =
      json.is_object() && json.contains("format") && json["format"] == TileTokenizer::kFormat;
  if (tiles) return std::make_unique<TileWords>(TileTokenizer::from_json(json, path.string()));
  return std::make_unique<FrameWords>(Tokenizer::from_json(json, path.string()));
}

}  // namespace mocaplm
