#include "gesture/segment.h"

#include <algorithm>
#include <map>

#include "common/error.h"
#include "common/text.h"

namespace mocaplm {

namespace {

Demonstration piece(const Recording& recording, const std::string& name, Eigen::Index from,
                    Eigen::Index to, const std::string& phase, const std::string& source) {
  const Eigen::Index n = to - from + 1;
  if (n < 4)
    throw DataError(in_file(source),
                    "phase \"" + phase + "\" of trajectory \"" + recording.name + "\", from " +
                        format_number(recording.time(from)) + " s, has " + std::to_string(n) +
                        (n == 1 ? " sample" : " samples") + ", at least 4 are needed");
  Demonstration one;
  one.name = name;
  one.time = recording.time.segment(from, n).array() - recording.time(from);
  one.values = recording.values.middleRows(from, n);
  one.more = recording.more.row(from).transpose();
  return one;
}

// One recording, walked through from its first sample to its last.
class Walk {
 public:
  Walk(const Recordings& recordings, const Recording& recording, const GestureConfig& config,
       Cut& cut)
      : source_(recordings.source), recording_(recording), config_(config), cut_(cut) {}

  void by_rules() {
    MotionEstimator estimator(config_.window);
    begin(0);
    const Eigen::Index n = recording_.time.size();
    for (Eigen::Index i = 0; i < n && phase_ < cut_.phases.size(); ++i) {
      const MotionState state =
          estimator.push(recording_.time(i), recording_.values.row(i).transpose());
      const std::string event =
          recording_.events.empty() ? "" : recording_.events[static_cast<std::size_t>(i)];
      if (const auto ago = watcher_->push(state, event)) end(i - static_cast<Eigen::Index>(*ago));
    }
    if (phase_ >= cut_.phases.size()) return;
    if (const auto ago = watcher_->finish())
      end(n - 1 - static_cast<Eigen::Index>(*ago));
    else
      ++cut_.unfinished;
  }

  void by_column() {
    const auto& phases = recording_.phases;
    for (std::size_t from = 0, to; from < phases.size(); from = to) {
      for (to = from; to < phases.size() && phases[to] == phases[from];) ++to;
      phase_ = static_cast<std::size_t>(
          std::find_if(cut_.phases.begin(), cut_.phases.end(),
                       [&](const auto& phase) { return phase.name == phases[from]; }) -
          cut_.phases.begin());
      began_ = static_cast<Eigen::Index>(from);
      // Up to and with the first sample of the next phase, as rules cut.
      keep(static_cast<Eigen::Index>(std::min(to, phases.size() - 1)));
    }
  }

 private:
  void begin(Eigen::Index at) {
    began_ = at;
    watcher_.emplace(cut_.phases[phase_].rule, config_.min_seconds);
    watcher_->begin(recording_.time(at));
  }

  void keep(Eigen::Index last) {
    PhaseDemonstrations& phase = cut_.phases[phase_];
    const int number = ++count_[phase_];
    const std::string name =
        recording_.name + (number > 1 ? " (" + std::to_string(number) + ")" : "");
    if (left_out(phase.name)) return;
    phase.all.push_back(piece(recording_, name, began_, last, phase.name, source_));
  }

  void end(Eigen::Index last) {
    if (last <= began_) return;
    keep(last);
    phase_ += 1;
    if (phase_ == cut_.phases.size() && config_.cycle) phase_ = 0;
    if (phase_ < cut_.phases.size()) begin(last);
  }

  bool left_out(const std::string& name) const {
    return std::find(config_.leave_out.begin(), config_.leave_out.end(), name) !=
           config_.leave_out.end();
  }

  const std::string& source_;
  const Recording& recording_;
  const GestureConfig& config_;
  Cut& cut_;
  std::size_t phase_ = 0;
  Eigen::Index began_ = 0;
  std::optional<RuleWatcher> watcher_;
  std::map<std::size_t, int> count_;
};

// The phases that the column names, in the order in which they are first seen.
std::vector<PhaseRule> named_phases(const Recordings& recordings) {
  std::vector<PhaseRule> phases;
  for (const Recording& recording : recordings.all)
    for (const std::string& name : recording.phases) {
      const auto same = [&](const PhaseRule& phase) { return phase.name == name; };
      if (std::any_of(phases.begin(), phases.end(), same)) continue;
      if (name.empty())
        throw DataError(in_file(recordings.source),
                        "trajectory \"" + recording.name + "\" has a row without a phase");
      phases.push_back({name, {}});
    }
  return phases;
}

}  // namespace

Cut cut_recordings(const Recordings& recordings, const GestureConfig& config) {
  std::vector<PhaseRule> rules = parse_phases(config.phases, recordings.coordinates);
  bool by_column = false;
  if (rules.empty()) {
    rules = named_phases(recordings);
    by_column = !rules.empty();
    for (const Recording& one : recordings.all)
      if (by_column && one.phases.empty())
        throw DataError(in_file(recordings.source),
                        "trajectory \"" + one.name + "\" has no column \"phase\", others do");
  }
  if (rules.empty()) rules = {{"movement", {}}};
  Cut cut;
  std::vector<std::string> names;
  for (const PhaseRule& rule : rules) {
    cut.phases.push_back({rule.name, rule.rule, {}});
    names.push_back(rule.name);
  }
  for (const std::string& name : config.leave_out)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw UsageError("leave_out: there is no phase \"" + name + "\"" +
                       known_names(name, names, "Phases"));
  for (const Recording& recording : recordings.all) {
    Walk walk(recordings, recording, config, cut);
    by_column ? walk.by_column() : walk.by_rules();
  }
  for (auto phase = cut.phases.begin(); phase != cut.phases.end();) {
    const bool out = std::find(config.leave_out.begin(), config.leave_out.end(), phase->name) !=
                     config.leave_out.end();
    if (!out && phase->all.empty())
      throw DataError(in_file(recordings.source),
                      "phase \"" + phase->name + "\" is never reached or never ends in " +
                          std::to_string(recordings.all.size()) + " trajectories");
    phase = out ? cut.phases.erase(phase) : phase + 1;
  }
  if (cut.phases.empty()) throw UsageError("leave_out: no phase is left");
  return cut;
}

}  // namespace mocaplm
