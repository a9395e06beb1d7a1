#include "app/tokenize_page.h"

#include "common/text.h"
#include "viewer/open.h"

namespace mocaplm {

Page tokenize_page(const TokenizeOptions& options, const std::filesystem::path& tokenizer_file,
                   const Table& table) {
  const std::unique_ptr<AnyTokenizer> tokenizer = load_tokenizer(tokenizer_file);
  ViewOptions view;
  view.inputs = options.inputs;
  view.read = options.read;
  if (view.inputs.size() > kTokenizedClips) view.inputs.resize(kTokenizedClips);
  Page page = open_page(view);
  std::vector<PageMotion> originals;
  originals.swap(page.motions);
  if (originals.size() > kTokenizedClips) originals.resize(kTokenizedClips);
  for (PageMotion& original : originals) {
    const Clip& clip = original.clip;
    const TokenStream stream = tokenizer->encode(clip);
    Clip decoded = tokenizer->decode(stream.ids, 0, clip.name, clip.trans.row(0).transpose());
    original.caption = "The clip";
    const std::string caption = "From " + std::to_string(stream.ids.size()) + " tokens";
    PageMotion told{original.title + ", from tokens", std::move(decoded), {}, {}, caption};
    page.motions.push_back(std::move(original));
    page.motions.push_back(std::move(told));
  }
  page.title = "Clips and what their tokens say";
  page.tables = {table};
  page.settings = {{"tokenizer", tokenizer_file.string()},
                   {"fingerprint", tokenizer->fingerprint()},
                   {"frames per second", format_number(tokenizer->frames().fps)},
                   {"characters", std::to_string(tokenizer->characters())},
                   {"root", tokenizer->frames().root}};
  if (tokenizer->tiles().tiles > 0)
    page.settings.emplace_back("frames a word", std::to_string(tokenizer->word_frames()));
  return page;
}

}  // namespace mocaplm
