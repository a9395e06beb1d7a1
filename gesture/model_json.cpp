#include <algorithm>
#include <limits>
#include <set>

#include "common/error.h"
#include "common/files.h"
#include "common/settings.h"
#include "gesture/model.h"

namespace mocaplm {

namespace {

constexpr std::int64_t kVersion = 1;
constexpr std::int64_t kMost = 100000;  // rows, columns, demonstrations: more is no model

Json json_of(const Eigen::VectorXd& vector) {
  return std::vector<double>(vector.data(), vector.data() + vector.size());
}

Json json_of(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    rows.push_back(json_of(Eigen::VectorXd(matrix.row(i).transpose())));
  return rows;
}

Eigen::VectorXd vector(JsonObject& object, const std::string& key, Eigen::Index size) {
  const std::vector<double> numbers = object.numbers(key);
  if (static_cast<Eigen::Index>(numbers.size()) != size)
    object.fail(key, "expected " + std::to_string(size) + " numbers, found " +
                         std::to_string(numbers.size()));
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), size);
}

Eigen::MatrixXd matrix(JsonObject& object, const std::string& key, Eigen::Index rows,
                       Eigen::Index columns) {
  const Json& json = object.raw(key);
  if (!json.is_array() || static_cast<Eigen::Index>(json.size()) != rows)
    object.fail(key, "expected a list of " + std::to_string(rows) + " rows");
  Eigen::MatrixXd all(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    JsonObject row(Json{{"row", json[static_cast<std::size_t>(i)]}},
                   object.place() + ": \"" + key + "\": row " + std::to_string(i));
    all.row(i) = vector(row, "row", columns).transpose();
  }
  return all;
}

Json phase_json(const PhaseModel& phase) {
  Json demonstrations = Json::array();
  for (std::size_t i = 0; i < phase.demonstrations.size(); ++i) {
    const Boundary& one = phase.demonstrations[i];
    demonstrations.push_back({{"name", phase.demonstration_names[i]},
                              {"duration", one.duration},
                              {"start", json_of(one.start)},
                              {"end", json_of(*one.end)},
                              {"more", one.more}});
  }
  return {{"name", phase.name},
          {"rule", phase.rule.text},
          {"coordinates", phase.coordinates},
          {"conditions", phase.conditions},
          {"harmonics", phase.harmonics},
          {"dof", phase.dof},
          {"rank", phase.rank},
          {"f", json_of(phase.f)},
          {"covariance", json_of(phase.covariance)},
          {"gram_inverse", json_of(phase.gram_inverse)},
          {"truncation", json_of(phase.truncation)},
          {"demonstrations", demonstrations}};
}

std::vector<std::string> names(JsonObject& object, const std::string& key, bool may_be_empty) {
  const std::vector<std::string> all = object.texts(key);
  const std::set<std::string> each(all.begin(), all.end());
  if (each.size() != all.size() || each.count("") > 0) object.fail(key, "expected different names");
  if (all.empty() && !may_be_empty) object.fail(key, "is empty");
  return all;
}

void read_demonstrations(JsonObject& object, PhaseModel& phase, std::size_t more) {
  const Json& list = object.raw("demonstrations");
  if (!list.is_array() || list.empty()) object.fail("demonstrations", "expected a list");
  for (std::size_t i = 0; i < list.size(); ++i) {
    JsonObject one(list[i], object.place() + ": \"demonstrations\": number " + std::to_string(i));
    phase.demonstration_names.push_back(one.text("name"));
    Boundary boundary;
    boundary.duration = one.number("duration", 1e-9, 1e9);
    boundary.start = vector(one, "start", phase.dimensions());
    boundary.end = vector(one, "end", phase.dimensions());
    const Eigen::VectorXd columns = vector(one, "more", static_cast<Eigen::Index>(more));
    boundary.more.assign(columns.data(), columns.data() + columns.size());
    one.finish();
    phase.demonstrations.push_back(boundary);
  }
}

PhaseModel read_phase(const Json& json, const std::string& place) {
  JsonObject object(json, place);
  PhaseModel phase;
  phase.name = object.text("name");
  if (phase.name.empty()) object.fail("name", "is empty");
  phase.coordinates = names(object, "coordinates", false);
  phase.conditions = names(object, "conditions", true);
  phase.harmonics = static_cast<int>(object.integer("harmonics", 1, 200));
  try {
    phase.rule = parse_rule(object.text("rule"), phase.coordinates);
  } catch (const UsageError& error) {
    object.fail("rule", error.what());
  }
  Eigen::Index k = 0;
  std::size_t more = 0;
  for (const std::string& condition : phase.conditions) {
    const bool own = is_own_condition(condition);
    more += own ? 0 : 1;
    k += own && condition != "duration" ? phase.dimensions() : 1;
  }
  const Eigen::Index m = phase.size(), v = phase.dimensions();
  phase.dof = object.integer("dof", 1, kMost);
  phase.rank = object.integer("rank", 1, k + 1);
  phase.f = matrix(object, "f", v * m, k + 1);
  phase.covariance = matrix(object, "covariance", v * m, m);
  phase.gram_inverse = matrix(object, "gram_inverse", k + 1, k + 1);
  phase.truncation = vector(object, "truncation", v);
  for (Eigen::Index i = 0; i < v * m; ++i)
    if (phase.covariance(i, i % m) < 0) object.fail("covariance", "a variance is negative");
  if ((phase.gram_inverse.diagonal().array() < 0).any())
    object.fail("gram_inverse", "a number on its diagonal is negative");
  if ((phase.truncation.array() < 0).any()) object.fail("truncation", "a number is negative");
  read_demonstrations(object, phase, more);
  object.finish();
  return phase;
}

}  // namespace

Json gesture_json(const GestureModel& model) {
  Json phases = Json::array();
  for (const PhaseModel& phase : model.phases) phases.push_back(phase_json(phase));
  return {{"format", "mocaplm gesture"},
          {"version", kVersion},
          {"settings", settings_json(model.config)},
          {"source", model.source},
          {"phases", phases}};
}

GestureModel gesture_from_json(const Json& json, const std::string& place) {
  JsonObject object(json, place);
  if (object.text("format") != "mocaplm gesture")
    object.fail("format", "expected \"mocaplm gesture\", found \"" + object.text("format") + "\"");
  object.integer("version", kVersion, kVersion);
  GestureModel model;
  JsonObject settings = object.object("settings");
  read_settings(model.config, settings);
  settings.finish();
  model.source = object.text("source");
  const Json& phases = object.raw("phases");
  if (!phases.is_array() || phases.empty()) object.fail("phases", "expected a list of phases");
  for (std::size_t i = 0; i < phases.size(); ++i) {
    model.phases.push_back(
        read_phase(phases[i], place + ": \"phases\": number " + std::to_string(i)));
    for (std::size_t j = 0; j < i; ++j)
      if (model.phases[j].name == model.phases[i].name)
        object.fail("phases", "two have the name \"" + model.phases[i].name + "\"");
    if (model.phases[i].coordinates != model.phases[0].coordinates)
      object.fail("phases", "they have different coordinates");
  }
  object.finish();
  return model;
}

void save_gesture(const std::filesystem::path& path, const GestureModel& model) {
  write_file(path, gesture_json(model).dump() + "\n");
}

GestureModel load_gesture(const std::filesystem::path& path) {
  return gesture_from_json(load_json(path), path.string());
}

}  // namespace mocaplm
