// The tree of joints, read word by word.
#include <algorithm>
#include <unordered_map>

#include "common/text.h"
#include "motion/formats/bvh_sections.h"
#include "motion/formats/joint_limits.h"

namespace mocaplm {

namespace {

// In any case.
bool begins_with_word(std::string_view word, std::string_view begin) {
  return same_word(word.substr(0, begin.size()), begin);
}

class HierarchyParser {
 public:
  HierarchyParser(BvhCursor& cursor, Bvh& bvh) : in_(cursor), bvh_(bvh) {}

  void parse() {
    in_.expect("ROOT");
    open_joint(-1);
    int current = 0;
    std::size_t depth = 1;
    while (current >= 0) {
      const std::string_view found = in_.word();
      BvhJoint& joint = bvh_.joints[static_cast<std::size_t>(current)];
      if (same_word(found, "OFFSET")) {
        joint.offset = offset();
      } else if (same_word(found, "CHANNELS")) {
        channels(joint);
      } else if (same_word(found, "JOINT")) {
        if (++depth > kMaxJointDepth)
          in_.fail(in_.last,
                   "joints are nested more than " + std::to_string(kMaxJointDepth) + " deep");
        open_joint(current);
        current = static_cast<int>(bvh_.joints.size()) - 1;
      } else if (is_end(found)) {
        end_site(found, joint);
      } else if (found == "}") {
        current = joint.parent;
        --depth;
      } else {
        in_.unexpected(found, "OFFSET, CHANNELS, JOINT, End Site or }");
      }
    }
    number_channels();
    say_slips();
  }

 private:
  // Columns follow the order of the joints in the text, wherever in a joint's block CHANNELS
  // stands.
  void number_channels() {
    int next = 0;
    for (BvhJoint& joint : bvh_.joints) {
      joint.first_channel = next;
      next += static_cast<int>(joint.channels.size());
    }
    if (next == 0) in_.fail(in_.at, "no joint has CHANNELS, so there is no motion to read");
  }

  void open_joint(int parent) {
    if (bvh_.joints.size() == kMaxJoints)
      in_.fail(in_.last, "more than " + std::to_string(kMaxJoints) + " joints");
    BvhJoint joint;
    joint.parent = parent;
    joint.name = unique(joint_name());
    bvh_.joints.push_back(std::move(joint));
    const std::string_view found = in_.word();
    if (found != "{") in_.unexpected(found, "{");
  }
  std::string joint_name() {
    const std::string_view name = in_.rest_of_line();
    if (name.empty()) in_.unexpected(in_.word(), "the joint's name");
    if (name.size() > 200) in_.fail(in_.last, "the joint's name is longer than 200 characters");
    return std::string(name);
  }
  // The tree tells joints of one name apart, so nothing is lost; maps and messages need names.
  std::string unique(const std::string& name) {
    int number = ++names_[name];
    if (number == 1) return name;
    std::string other;
    do other = name + "_" + std::to_string(number++);
    while (names_.count(other) > 0);
    names_[name] = number - 1;
    names_[other] = 1;
    if (doubled_.empty())
      doubled_ = shown(name) + ", the second of which is called " + shown(other);
    ++doubles_;
    return other;
  }

  Eigen::Vector3d offset() {
    const double x = in_.number("the OFFSET's x"), y = in_.number("the OFFSET's y"),
                 z = in_.number("the OFFSET's z");
    return {x, y, z};
  }

  void channels(BvhJoint& joint) {
    if (!joint.channels.empty())
      in_.fail(in_.last, "joint " + shown(joint.name) + " has CHANNELS twice");
    const std::size_t n = in_.count("the number of CHANNELS", 6);
    for (std::size_t i = 0; i < n; ++i) {
      const std::string_view found = in_.word();
      const auto& names = bvh_channel_names();
      const auto name = std::find_if(names.begin(), names.end(),
                                     [&](const std::string& s) { return same_word(found, s); });
      if (name == names.end()) in_.unexpected(found, "one of " + join(names, ", "));
      const auto channel = static_cast<BvhChannel>(name - names.begin());
      if (std::find(joint.channels.begin(), joint.channels.end(), channel) != joint.channels.end())
        in_.fail(in_.last, "joint " + shown(joint.name) + " has the channel " + *name + " twice");
      joint.channels.push_back(channel);
    }
  }

  // "End Site", as nearly all write; "EndSite" and "End_Site" in one word.
  static bool is_end(std::string_view word) {
    return same_word(word, "End") || begins_with_word(word, "EndSite") ||
           begins_with_word(word, "End_Site");
  }
  // "End Site Head_end", "End Site_foo", "End Effector": the name says nothing that is needed.
  void end_site(std::string_view end, BvhJoint& joint) {
    const bool one_word = !same_word(end, "End");
    const std::string_view kind = in_.rest_of_line();
    if (!one_word && !begins_with_word(kind, "Site") && !begins_with_word(kind, "Effector"))
      in_.unexpected(kind.empty() ? in_.word() : kind, "Site");
    if (one_word || !same_word(kind, "Site")) {
      if (named_.empty())
        named_ = shown(std::string(end) + (kind.empty() ? "" : " " + std::string(kind))) + " of " +
                 shown(joint.name);
      ++named_ends_;
    }
    std::string_view found = in_.word();
    if (found != "{") in_.unexpected(found, "{");
    if (joint.end_sites.size() == kMaxJoints) in_.fail(in_.last, "too many End Sites in one joint");
    in_.expect("OFFSET");
    joint.end_sites.push_back(offset());
    found = in_.word();
    if (same_word(found, "CHANNELS")) {
      in_.count("the number of an End Site's CHANNELS, which has none", 0);
      found = in_.word();
    }
    if (found != "}") in_.unexpected(found, "}");
  }

  void say_slips() {
    if (named_ends_ > 0)
      bvh_.remarks.push_back({"named End Sites", std::to_string(named_ends_) +
                                                     " End Sites have names (" + named_ +
                                                     "), which are not kept"});
    if (doubles_ > 0)
      bvh_.remarks.push_back(
          {"doubled joint names",
           std::to_string(doubles_) + " joints have the name of another (" + doubled_ + ")"});
  }

  BvhCursor& in_;
  Bvh& bvh_;
  std::unordered_map<std::string, int> names_;  // how many joints have each
  std::string named_, doubled_;                 // the first of each
  int named_ends_ = 0, doubles_ = 0;
};

}  // namespace

const std::vector<std::string>& bvh_channel_names() {
  static const std::vector<std::string> names = {"Xposition", "Yposition", "Zposition",
                                                 "Xrotation", "Yrotation", "Zrotation"};
  return names;
}

void parse_hierarchy(BvhCursor& cursor, Bvh& bvh) {
  HierarchyParser(cursor, bvh).parse();
}

}  // namespace mocaplm
