#include "model/config.h"

#include <algorithm>

#include "common/error.h"
#include "model/input.h"

namespace mocaplm {

namespace {
constexpr std::int64_t kFormat = 1;

void check_divides(const char* heads_name, std::int64_t heads, const char* width_name,
                   std::int64_t width) {
  if (width % heads != 0)
    throw UsageError(std::string(heads_name) + " (" + std::to_string(heads) + ") must divide " +
                     width_name + " (" + std::to_string(width) + ")");
}

}  // namespace

void check_model(const ModelDescription& d) {
  const ModelConfig& c = d.config;
  check_divides("n_head", c.n_head, "n_embd", c.n_embd);
  if (d.frame_positions())
    check_divides("decoder_head", c.decoder_head, "decoder_embd", c.decoder_embd);
  if (d.frame_positions() && d.shape.channels % kJointChannels != 0)
    throw UsageError("\"frames\" decides three channels together, and the tokenizer has " +
                     std::to_string(d.shape.channels) + ": expected a multiple of three");
  if (d.masked() && d.frame_positions())
    throw UsageError(
        "objective masked needs architecture flat: a model of frames has no positions "
        "for single tokens");
  if (d.has_pieces() && (d.frame_positions() || d.masked()))
    throw UsageError("pieces (bpe, unigram) need architecture flat and objective causal");
  const auto extra = static_cast<std::int64_t>(d.classes.size());
  const std::int64_t need =
      d.prefix() + extra + 2 * (d.frame_positions() ? 1 : d.shape.tokens_per_frame());
  if (d.class_frames < 0 || d.class_frames > std::max<std::int64_t>(frames_in_window(d, extra), 0))
    throw UsageError("class_frames " + std::to_string(d.class_frames) +
                     ": the context has room for " + std::to_string(frames_in_window(d, extra)));
  if (c.block_size < need)
    throw UsageError("block_size " + std::to_string(c.block_size) +
                     " is too small: two frames and the condition tokens need " +
                     std::to_string(need));
}

Json to_json(const ModelDescription& d) {
  Json json{{"format", kFormat}, {"model", settings_json(d.config)}};
  json["stream"] = {{"vocabulary", d.shape.vocabulary},
                    {"first_bin", d.shape.first_bin},
                    {"bins", d.shape.bins},
                    {"channels", d.shape.channels}};
  if (d.has_pieces()) {
    json["stream"]["pieces"] = d.shape.pieces;
    json["stream"]["longest"] = d.shape.longest;
    json["pieces_fingerprint"] = d.pieces_fingerprint;
  }
  json["tokenizer_fingerprint"] = d.tokenizer_fingerprint;
  json["conditions"] = d.conditions;
  json["classes"] = Json::array();
  for (const auto& [label, values] : d.classes)
    json["classes"].push_back({{"label", label}, {"values", values}});
  json["class_frames"] = d.class_frames;
  json["procedural"] = d.procedural;
  json["training"] = d.training;
  return json;
}

ModelDescription model_from_json(const Json& json, const std::string& place) {
  ModelDescription d;
  JsonObject top(json, place);
  top.integer("format", kFormat, kFormat);
  JsonObject model = top.object("model");
  read_settings(d.config, model);
  model.finish();
  JsonObject stream = top.object("stream");
  d.shape.bins = stream.integer("bins", 2, 4096);
  d.shape.channels = stream.integer("channels", 1, 1000);
  d.shape.first_bin = stream.integer("first_bin", 1, 1000);
  if (stream.has("pieces")) {
    d.shape.pieces = stream.integer("pieces", 1, 65536);
    d.shape.longest = stream.integer("longest", 2, d.shape.tokens_per_frame());
    d.pieces_fingerprint = top.text("pieces_fingerprint");
  }
  d.shape.vocabulary =
      stream.integer("vocabulary", d.shape.first_bin + d.shape.bins + d.shape.pieces, 200000);
  stream.finish();
  d.tokenizer_fingerprint = top.text("tokenizer_fingerprint");
  d.conditions = top.texts("conditions");
  const Json& classes = top.raw("classes");
  if (!classes.is_array()) top.fail("classes", "expected a list, found " + classes.dump());
  for (const Json& item : classes) {
    JsonObject one(item, place + ": \"classes\"");
    const std::string label = one.text("label");
    d.classes.emplace_back(label, one.texts("values"));
    one.finish();
  }
  d.class_frames = top.integer("class_frames", 0);
  d.procedural = top.boolean("procedural");
  d.training = top.raw("training");
  top.finish();
  try {
    check_model(d);
  } catch (const UsageError& error) {
    throw DataError(in_file(place), error.what());
  }
  return d;
}

std::int64_t frames_in_window(const ModelDescription& d, std::int64_t reserve) {
  const std::int64_t room = d.config.block_size - d.prefix() - reserve;
  return d.frame_positions() ? room : room / d.shape.tokens_per_frame();
}

std::int64_t tokens_in_window(const ModelDescription& d, std::int64_t reserve) {
  return d.frame_positions()
             ? d.prefix() + frames_in_window(d, reserve) * d.shape.tokens_per_frame()
             : d.config.block_size - reserve;
}

ModelSizes model_sizes(const ModelDescription& d) {
  const ModelConfig& c = d.config;
  const std::int64_t frames =
      d.frame_positions() ? c.block_size : c.block_size / d.shape.fewest_tokens_per_frame();
  return {frames + 3, (d.shape.channels + 2) * d.shape.longest, 2 * c.reach + 2, 2 * c.reach + 1};
}

namespace {

// Of `layers` blocks and the norm after them.
double block_parameters(double width, std::int64_t layers) {
  return width * (static_cast<double>(layers) * (12 * width + 13) + 2);
}

double flat_parameters(const ModelDescription& d, double width, double outputs) {
  const ModelConfig& c = d.config;
  const ModelSizes sizes = model_sizes(d);
  auto rows = static_cast<double>(d.shape.vocabulary);
  rows += static_cast<double>(
      c.position == "custom" ? sizes.frame_positions + sizes.channel_positions : c.block_size);
  if (c.history) rows += 3 * static_cast<double>(sizes.history_rows);
  return rows * width + block_parameters(width, c.n_layer) + outputs * (width + 1);
}

double frames_parameters(const ModelDescription& d, double width, double outputs) {
  const ModelConfig& c = d.config;
  const auto vocabulary = static_cast<double>(d.shape.vocabulary),
             channels = static_cast<double>(d.shape.channels),
             context = static_cast<double>(c.block_size),
             narrow = static_cast<double>(c.decoder_embd);
  const double features = channels * kFrameFeatures, joints = channels / kJointChannels;
  const double time =
      (vocabulary + context + features + 1) * width + block_parameters(width, c.n_layer);
  const double joint_in = (width + features + 1) * joints * narrow;
  // Rows of tables and inputs of linear layers, all `narrow` wide: of joints, then of channels.
  double rows = (kJointChannels * kFrameFeatures + 1) + 2 * joints + 1 + context;
  rows += kJointChannels * (narrow + 1) + (kFrameFeatures + 1) + channels;
  constexpr double kChosen = 2 * kJointChannels - 1;
  rows += kChosen * static_cast<double>(d.shape.bins) + 2;
  if (c.history) {
    const auto history = static_cast<double>(model_sizes(d).history_rows);
    rows += kChosen * history + 2 + 2 * history;
  }
  const double feed_forward = narrow * (kFeedForward * (2 * narrow + 1) + 5);
  return time + joint_in + rows * narrow + block_parameters(narrow, c.memory_layer) +
         block_parameters(narrow, c.decoder_layer) - 4 * narrow + feed_forward +
         outputs * (narrow + 1);
}

}  // namespace

double parameter_count(const ModelDescription& d) {
  const ModelConfig& c = d.config;
  auto outputs = static_cast<double>(d.shape.vocabulary);
  if (c.output == "extrapolation") outputs += static_cast<double>(model_sizes(d).offsets);
  const auto width = static_cast<double>(c.n_embd);
  return d.frame_positions() ? frames_parameters(d, width, outputs)
                             : flat_parameters(d, width, outputs);
}

}  // namespace mocaplm
