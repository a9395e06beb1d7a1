#include "experiments/result.h"

namespace mocaplm {

Json to_json(const RowResult& r) {
  Json accuracy = Json::array();
  for (const MethodAccuracy& method : r.accuracy) {
    Json labels = Json::array();
    for (const auto& [label, share] : method.labels)
      labels.push_back({{"label", label}, {"accuracy", share}});
    accuracy.push_back({{"method", method.method}, {"labels", labels}});
  }
  return {{"name", r.name},
          {"row", r.line},
          {"column", r.column},
          {"fps", r.fps},
          {"bins", r.bins},
          {"binning", r.binning},
          {"joints", r.joints},
          {"bits_of_a_frame", r.bits},
          {"order_2_bits_of_a_frame", r.order_2},
          {"frames", r.frames},
          {"predicted_tokens_of_a_frame", r.predicted},
          {"masked", r.masked},
          {"parameters", r.parameters},
          {"steps", r.steps},
          {"minutes", r.minutes},
          {"accuracy", accuracy}};
}

RowResult result_from_json(const Json& json, const std::string& place) {
  JsonObject object(json, place);
  RowResult r;
  r.name = object.text("name");
  r.line = object.text("row");
  r.column = object.text("column");
  r.fps = object.number("fps", 0);
  r.bins = object.integer("bins", 0);
  r.binning = object.text("binning");
  for (const double joint : object.numbers("joints")) r.joints.push_back(static_cast<int>(joint));
  r.bits = object.numbers("bits_of_a_frame");
  r.order_2 = object.numbers("order_2_bits_of_a_frame");
  r.frames = object.integer("frames", 0);
  r.predicted = object.integer("predicted_tokens_of_a_frame", 0);
  r.masked = object.boolean("masked");
  r.parameters = object.integer("parameters", 0);
  r.steps = object.integer("steps", 0);
  r.minutes = object.number("minutes", 0);
  for (const Json& item : object.raw("accuracy")) {
    JsonObject method(item, place + ": \"accuracy\"");
    MethodAccuracy one;
    one.method = method.text("method");
    for (const Json& pair : method.raw("labels")) {
      JsonObject label(pair, place + ": \"labels\"");
      const std::string name = label.text("label");
      one.labels.emplace_back(name, label.number("accuracy", 0, 1));
      label.finish();
    }
    method.finish();
    r.accuracy.push_back(one);
  }
  object.finish();
  const auto channels = static_cast<std::int64_t>(r.order_2.size());
  if (r.accuracy.empty() && (r.rotations() > channels || r.bits.size() != r.order_2.size() + 1))
    object.fail("bits_of_a_frame", "does not fit the joints");
  return r;
}

}  // namespace mocaplm
