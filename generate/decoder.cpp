#include "generate/decoder.h"

#include <stdexcept>

#include "common/error.h"
#include "generate/flat_decoder.h"
#include "generate/frame_decoder.h"
#include "generate/piece_decoder.h"

namespace mocaplm {

void Decoder::set_order(std::int64_t, const std::vector<int>&) {
  throw std::logic_error("this model decodes channels in one order only");
}

std::unique_ptr<Decoder> make_decoder(const StoredModel& model, const std::string& place,
                                      const EngineOptions& options) {
  if (model.description.masked())
    throw UsageError(place + " is a masked model: it fills gaps (mocaplm infill) and cannot go on");
  if (model.description.frame_positions())
    return std::make_unique<FrameDecoder>(model, place, options);
  if (model.description.has_pieces()) return std::make_unique<PieceDecoder>(model, place, options);
  return std::make_unique<FlatDecoder>(model, place, options);
}

}  // namespace mocaplm
