#include "motion/formats/recognise.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "motion/formats/joint_words.h"
#include "motion/formats/recognise_guess.h"

namespace mocaplm {

namespace {

// A limb's joints from the trunk outwards; -1 where there is none.
struct LimbJoints {
  std::vector<int> path;
  int first = -1;                        // collar
  int root = -1, middle = -1, end = -1;  // hip, knee, ankle; shoulder, elbow, wrist
  int tip = -1;                          // toes, a knuckle
  bool named = false;                    // its words say it
};

// Two limbs that mirror each other, hanging from one joint.
struct Pair {
  int parent = -1;
  LimbJoints left, right;
  double reach = 0;
  int leg_words = 0, arm_words = 0;
};

class Recogniser {
 public:
  explicit Recogniser(const Bvh& bvh) : bvh_(bvh) {
    std::vector<std::string> names;
    for (const BvhJoint& joint : bvh.joints) names.push_back(joint.name);
    words_ = joint_words(names);
    if (bvh.frames() > 0)
      pose_bvh(bvh, Eigen::Index{0}, pose_);
    else
      pose_ = rest_bvh(bvh);
    const std::size_t n = bvh.joints.size();
    children_.resize(n);
    length_.assign(n, 0);
    reach_.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const int parent = bvh.joints[i].parent;
      if (parent < 0) continue;
      children_[static_cast<std::size_t>(parent)].push_back(static_cast<int>(i));
      length_[i] = (pose_.positions[i] - pose_.positions[static_cast<std::size_t>(parent)]).norm();
      inherit_side(i);
    }
    for (std::size_t i = n; i-- > 0;) {
      double end = 0;
      for (const auto& site : bvh.joints[i].end_sites) end = std::max(end, site.norm());
      reach_[i] = std::max(reach_[i], end);
      const int parent = bvh.joints[i].parent;
      if (parent >= 0) {
        auto& above = reach_[static_cast<std::size_t>(parent)];
        above = std::max(above, reach_[i] + length_[i]);
      }
    }
  }

  Recognised run() {
    Recognised out;
    out.joints.fill(-1);
    find_pairs();
    if (pairs_.size() < 2) {
      out.doubt = pairs_.empty() ? "no two limbs are each other's mirror image"
                                 : "only one pair of limbs was found";
      guess_by_words(words_, out.joints);
      return out;
    }
    choose(out);
    return out;
  }

 private:
  Side side(int joint) const { return words_[static_cast<std::size_t>(joint)].side; }
  Part part(int joint) const { return words_[static_cast<std::size_t>(joint)].part; }
  double length(int joint) const { return length_[static_cast<std::size_t>(joint)]; }
  const Eigen::Vector3d& at(int joint) const {
    return pose_.positions[static_cast<std::size_t>(joint)];
  }
  const std::vector<int>& children(int joint) const {
    return children_[static_cast<std::size_t>(joint)];
  }

  // What hangs from a left joint is left, unless it says otherwise.
  void inherit_side(std::size_t joint) {
    const Side above = side(bvh_.joints[joint].parent);
    if (words_[joint].side == Side::none) words_[joint].side = above;
  }

  // Whether two children of one joint may be the two sides' limbs.
  bool mirrored(int a, int b) const {
    if (side(a) != Side::none || side(b) != Side::none) {
      if (side(a) == side(b)) return false;
      if (side(a) == Side::none || side(b) == Side::none) return is_the_other(a, b);
      const auto& wa = words_[static_cast<std::size_t>(a)];
      const auto& wb = words_[static_cast<std::size_t>(b)];
      return wa.bare == wb.bare || wa.part == wb.part;
    }
    // Where the names know sides, a limb has one.
    return !sided_ && part(a) == part(b) && alike(a, b);
  }

  // One of two limbs has no side in its name: it is the other's when it is built like it, and no
  // third one is named to be.
  bool is_the_other(int a, int b) const {
    const int named = side(a) == Side::none ? b : a;
    for (const int other : children(bvh_.joints[static_cast<std::size_t>(named)].parent))
      if (other != named && side(other) != Side::none && side(other) != side(named) &&
          part(other) == part(named))
        return false;
    return alike(a, b);
  }

  // Three joints or more, each as far from the one before as the other limb's.
  bool alike(int a, int b) const {
    const std::vector<int> pa = limb_path(a), pb = limb_path(b);
    if (pa.size() != pb.size() || pa.size() < 3) return false;
    const double whole = reach_[static_cast<std::size_t>(a)] + length(a);
    for (std::size_t i = 0; i < pa.size(); ++i)
      if (std::abs(length(pa[i]) - length(pb[i])) > 0.05 * whole) return false;
    return true;
  }

  void find_pairs() {
    const double all = *std::max_element(reach_.begin(), reach_.end());
    std::size_t left = 0, right = 0;
    for (const JointWord& word : words_) {
      left += word.side == Side::left;
      right += word.side == Side::right;
    }
    sided_ = left >= 4 && right >= 4;
    for (std::size_t i = 0; i < children_.size(); ++i) {
      // Inside a limb there are fingers and toes.
      if (words_[i].side != Side::none) continue;
      const auto& below = children_[i];
      for (std::size_t a = 0; a < below.size(); ++a)
        for (std::size_t b = a + 1; b < below.size(); ++b)
          if (mirrored(below[a], below[b])) add_pair(static_cast<int>(i), below[a], below[b], all);
    }
    // Without names fingers look like limbs: what hangs inside a limb is none.
    std::vector<Pair> outer;
    for (const Pair& pair : pairs_) {
      bool inside = false;
      for (const Pair& other : pairs_)
        for (const LimbJoints* limb : {&other.left, &other.right})
          inside = inside || is_below(bvh_, pair.parent, limb->path.front());
      if (!inside) outer.push_back(pair);
    }
    pairs_ = outer;
  }

  void add_pair(int parent, int a, int b, double all) {
    Pair pair;
    pair.parent = parent;
    const bool swapped = side(a) == Side::right || side(b) == Side::left;
    pair.left.path = limb_path(swapped ? b : a);
    pair.right.path = limb_path(swapped ? a : b);
    pair.reach = std::min(reach_[static_cast<std::size_t>(a)] + length(a),
                          reach_[static_cast<std::size_t>(b)] + length(b));
    for (const LimbJoints* limb : {&pair.left, &pair.right})
      for (const int joint : limb->path) {
        const Part p = part(joint);
        pair.arm_words += p >= Part::collar && p <= Part::finger;
        pair.leg_words += p >= Part::hip;
      }
    // Eyes, breasts, ribbons.
    const bool words = pair.arm_words + pair.leg_words >= 4;
    if (pair.left.path.size() < 2 || pair.right.path.size() < 2) return;
    if (pair.reach < (words ? 0.12 : 0.25) * all) return;
    pairs_.push_back(pair);
  }

  // Outwards from the trunk, at each fork towards what the names or else the lengths say is the
  // limb.
  std::vector<int> limb_path(int joint) const {
    std::vector<int> path;
    while (joint >= 0) {
      path.push_back(joint);
      int best = -1;
      double best_score = -1;
      for (const int child : children(joint)) {
        const Part p = part(child);
        double score = reach_[static_cast<std::size_t>(child)] + length(child);
        const double most = 1 + *std::max_element(reach_.begin(), reach_.end());
        if (p != Part::helper && p != Part::unknown) score += most;
        if (p != Part::helper && p != Part::unknown && p != Part::finger) score += most;
        if (p == Part::helper && !leads_on(child)) score -= most;
        if (score > best_score || best < 0) {
          best = child;
          best_score = score;
        }
      }
      if (best >= 0 && part(best) == Part::helper && !leads_on(best)) best = -1;
      joint = best;
    }
    return path;
  }
  // A helper inside a limb (a buttock, a hip joint, a twist bone in line) has the limb below it.
  bool leads_on(int joint) const {
    for (const int child : children(joint)) {
      const Part p = part(child);
      if ((p != Part::helper && p != Part::unknown) || leads_on(child)) return true;
    }
    return false;
  }

  int first_on(const LimbJoints& limb, std::size_t from, std::initializer_list<Part> parts) const {
    for (std::size_t i = from; i < limb.path.size(); ++i)
      if (std::find(parts.begin(), parts.end(), part(limb.path[i])) != parts.end())
        return static_cast<int>(i);
    return -1;
  }
  int joint_at(const LimbJoints& limb, int index) const {
    return index < 0 || index >= static_cast<int>(limb.path.size())
               ? -1
               : limb.path[static_cast<std::size_t>(index)];
  }

  // Places on the path: root, middle, end.
  void name_leg(LimbJoints& limb) const {
    int root = first_on(limb, 0, {Part::thigh});
    if (root < 0) root = first_on(limb, 0, {Part::hip});
    if (root < 0) root = first_on(limb, 0, {Part::leg});
    const auto after = [&](int i) { return static_cast<std::size_t>(i + 1); };
    int middle = root < 0 ? -1 : first_on(limb, after(root), {Part::shin});
    if (root >= 0 && middle < 0) middle = first_on(limb, after(root), {Part::leg});
    int end = middle < 0 ? -1 : first_on(limb, after(middle), {Part::foot_or_ankle});
    if (middle >= 0 && end < 0) end = first_on(limb, after(middle), {Part::toe});
    settle(limb, root, middle, end);
    const auto ankle = std::find(limb.path.begin(), limb.path.end(), limb.end);
    if (limb.end >= 0)
      limb.tip = joint_at(limb, next_long(limb, static_cast<int>(ankle - limb.path.begin())));
  }
  void name_arm(LimbJoints& limb) const {
    int middle = first_on(limb, 0, {Part::forearm});
    int root = first_on(limb, 0, {Part::upper_arm});
    if (root < 0) root = first_on(limb, 0, {Part::arm});
    const auto after = [&](int i) { return static_cast<std::size_t>(i + 1); };
    if (middle < 0 && root >= 0) middle = first_on(limb, after(root), {Part::arm});
    if (root < 0 || (middle >= 0 && root >= middle)) {
      root = first_on(limb, 0, {Part::shoulder_or_collar});
      if (middle >= 0 && root >= middle) root = -1;
      // "Collar, Shoulder, Elbow", and "Shoulder, Elbow".
    }
    const int end = middle < 0 ? -1 : first_on(limb, after(middle), {Part::hand});
    settle(limb, root, middle, end);
    int collar = first_on(limb, 0, {Part::collar});
    if (collar < 0) collar = first_on(limb, 0, {Part::shoulder_or_collar});
    if (limb.named && collar >= 0 && collar < root) limb.first = joint_at(limb, collar);
  }

  // By words where they are whole, else by the two longest bones in a row.
  void settle(LimbJoints& limb, int root, int middle, int end) const {
    limb.named = root >= 0 && middle > root && (end > middle || end < 0);
    if (!limb.named) {
      double best = 0;
      for (std::size_t i = 0; i + 1 < limb.path.size(); ++i) {
        const double upper = length(limb.path[i + 1]);
        const double lower =
            i + 2 < limb.path.size() ? length(limb.path[i + 2]) : end_site(limb.path[i + 1]);
        const double shorter = std::min(upper, lower);
        if (shorter <= best || upper > 2.5 * lower || lower > 2.5 * upper) continue;
        best = shorter;
        root = static_cast<int>(i);
        middle = root + 1;
        end = root + 2;
      }
    }
    limb.root = joint_at(limb, root);
    limb.middle = joint_at(limb, middle);
    limb.end = joint_at(limb, end);
    if (!limb.named && root > 0 && length(limb.path[static_cast<std::size_t>(root)]) > 0)
      limb.first = joint_at(limb, root - 1);
  }
  double end_site(int joint) const {
    double longest = 0;
    for (const auto& site : bvh_.joints[static_cast<std::size_t>(joint)].end_sites)
      longest = std::max(longest, site.norm());
    return longest;
  }
  // The next joint outwards that does not lie in the same place.
  int next_long(const LimbJoints& limb, int index) const {
    const double whole = length(limb.middle) + (limb.end < 0 ? 0 : length(limb.end));
    for (int i = index + 1; i < static_cast<int>(limb.path.size()); ++i)
      if (length(joint_at(limb, i)) > 0.03 * whole && part(joint_at(limb, i)) != Part::helper)
        return i;
    return -1;
  }

  void choose(Recognised& out) {
    std::stable_sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
      return a.arm_words + a.leg_words != b.arm_words + b.leg_words
                 ? a.arm_words + a.leg_words > b.arm_words + b.leg_words
                 : a.reach > b.reach;
    });
    Pair legs, arms;
    const auto is_leg = [](const Pair& p) { return p.leg_words > p.arm_words; };
    const auto is_arm = [](const Pair& p) { return p.arm_words > p.leg_words; };
    const auto leg = std::find_if(pairs_.begin(), pairs_.end(), is_leg);
    const auto arm = std::find_if(pairs_.begin(), pairs_.end(), is_arm);
    const auto legs_named = std::count_if(pairs_.begin(), pairs_.end(), is_leg);
    if (leg != pairs_.end() && arm != pairs_.end()) {
      legs = *leg;
      arms = *arm;
    } else {
      // Without words: the two longest pairs; legs hang nearer to the root, else are the longer
      // ones.
      std::stable_sort(pairs_.begin(), pairs_.end(),
                       [](const Pair& a, const Pair& b) { return a.reach > b.reach; });
      const Pair &a = pairs_[0], &b = pairs_[1];
      const int da = depth(a.parent), db = depth(b.parent);
      const bool a_legs = da != db ? da < db : true;
      legs = a_legs ? a : b;
      arms = a_legs ? b : a;
      if (pairs_.size() > 2 && pairs_[2].reach > 0.6 * arms.reach)
        out.doubt = "more than two pairs of limbs look alike";
    }
    if (legs_named > 1) {
      int strong = 0;
      for (const Pair& pair : pairs_) strong += is_leg(pair) && pair.reach > 0.5 * legs.reach;
      if (strong > 1 && arm == pairs_.end()) out.doubt = "it has more than two legs";
    }
    if (arm != pairs_.end() && is_leg_like(arms)) out.doubt = "its forelimbs end in feet";
    for (LimbJoints* limb : {&legs.left, &legs.right}) name_leg(*limb);
    for (LimbJoints* limb : {&arms.left, &arms.right}) name_arm(*limb);
    fill(out, legs, arms);
    check(out, legs, arms);
  }
  bool is_leg_like(const Pair& arms) const {
    for (const int joint : arms.left.path) {
      const std::string& bare = words_[static_cast<std::size_t>(joint)].bare;
      for (const char* word : {"paw", "hoof", "foreleg", "frontleg", "fetlock", "wing"})
        if (bare.find(word) != bare.npos) return true;
    }
    return false;
  }
  int depth(int joint) const {
    int d = 0;
    for (; joint >= 0; joint = bvh_.joints[static_cast<std::size_t>(joint)].parent) ++d;
    return d;
  }

  void fill(Recognised& out, Pair& legs, Pair& arms) {
    auto& j = out.joints;
    j[0] = legs.parent;
    const int sides[2][4] = {{1, 4, 7, 10}, {2, 5, 8, 11}};
    const int arm_sides[2][4] = {{13, 16, 18, 20}, {14, 17, 19, 21}};
    for (int s = 0; s < 2; ++s) {
      const LimbJoints& l = s == 0 ? legs.left : legs.right;
      const int leg[4] = {l.root, l.middle, l.end, l.tip};
      const LimbJoints& a = s == 0 ? arms.left : arms.right;
      const int arm[4] = {a.first, a.root, a.middle, a.end};
      for (int k = 0; k < 4; ++k) {
        j[static_cast<std::size_t>(sides[s][k])] = leg[k];
        j[static_cast<std::size_t>(arm_sides[s][k])] = arm[k];
      }
    }
    if (!sides_known(legs) && out.doubt.empty()) find_sides(out);
    // The joint that turns the hips may hang beside the spine (iClone).
    const int trunk = common_ancestor(bvh_, legs.parent, arms.parent);
    std::vector<int> spine = path_down(bvh_, trunk, arms.parent);
    while (!spine.empty() && part(spine.back()) == Part::neck) {
      // 3ds Max hangs the arms from the neck.
      if (j[12] < 0) j[12] = spine.back();
      spine.pop_back();
    }
    if (trunk == arms.parent && trunk != legs.parent)
      out.doubt = "the arms do not hang above the legs";
    std::vector<double> heights;
    for (const int joint : spine) heights.push_back((at(joint) - at(legs.parent)).norm());
    assign_spine(spine, heights, j);
    find_head(out, arms.parent);
  }
  bool sides_known(const Pair& pair) const { return side(pair.left.path.front()) == Side::left; }

  // Left is where up and the way that the toes point say: up x forward.
  void find_sides(Recognised& out) {
    auto& j = out.joints;
    const BvhPose rest = rest_bvh(bvh_);
    const auto p = [&](int smpl) {
      return rest.positions[static_cast<std::size_t>(j[static_cast<std::size_t>(smpl)])];
    };
    if (j[10] < 0 || j[11] < 0 || j[7] < 0 || j[8] < 0 || j[16] < 0 || j[17] < 0) {
      out.doubt = "no name tells left from right, and there are no toes to tell the front";
      return;
    }
    const Eigen::Vector3d up = 0.5 * (p(16) + p(17)) - 0.5 * (p(1) + p(2));
    const Eigen::Vector3d forward = p(10) - p(7) + p(11) - p(8);
    const Eigen::Vector3d left = up.cross(forward);
    if (left.normalized().dot((p(1) - p(2)).normalized()) < 0)
      for (int smpl = 0; smpl < kJoints; ++smpl) {
        const int other = mirrored_joints()[static_cast<std::size_t>(smpl)];
        if (other > smpl)
          std::swap(j[static_cast<std::size_t>(smpl)], j[static_cast<std::size_t>(other)]);
      }
    if (std::abs(left.normalized().dot((p(1) - p(2)).normalized())) < 0.7)
      out.doubt = "no name tells left from right, and the zero pose does not stand";
  }

  // Up from where the arms hang: the child without a side that says so, or leads furthest.
  void find_head(Recognised& out, int from) {
    auto& j = out.joints;
    std::vector<int> chain;
    for (int joint = from; joint >= 0;) {
      int best = -1;
      double best_score = -1;
      for (const int child : children(joint)) {
        if (side(child) != Side::none || is_limb(out, child)) continue;
        const Part p = part(child);
        const double score = (p == Part::neck || p == Part::head ? 1e9 : 0) +
                             (p == Part::helper ? -1e9 : 0) + length(child) +
                             reach_[static_cast<std::size_t>(child)];
        if (score > best_score) {
          best = child;
          best_score = score;
        }
      }
      if (best < 0 || best_score < 0) break;
      chain.push_back(best);
      if (part(best) == Part::head) break;
      joint = best;
    }
    if (chain.empty()) return;
    // Without a word the last is the head; one that lies in its parent's place is none.
    const bool named = part(chain.back()) == Part::head;
    while (!named && chain.size() > 1 && length(chain.back()) <= 0) chain.pop_back();
    j[15] = chain.back();
    if (chain.size() > 1 && j[12] < 0) j[12] = chain.front();
    if (chain.size() == 1 && part(chain[0]) == Part::neck && j[12] < 0) {
      j[12] = chain[0];
      j[15] = -1;
    }
  }
  bool is_limb(const Recognised& out, int joint) const {
    for (const int smpl : {1, 2, 13, 14, 16, 17})
      if (out.joints[static_cast<std::size_t>(smpl)] >= 0 &&
          is_below(bvh_, out.joints[static_cast<std::size_t>(smpl)], joint))
        return true;
    return false;
  }

  void check(Recognised& out, const Pair& legs, const Pair& arms) {
    if (!out.doubt.empty()) return;
    const auto& j = out.joints;
    for (const int smpl : {0, 1, 2, 4, 5, 16, 17, 18, 19})
      if (j[static_cast<std::size_t>(smpl)] < 0) {
        out.doubt = "no joint was found for " + joint_names()[static_cast<std::size_t>(smpl)];
        return;
      }
    const bool named = legs.left.named && legs.right.named && arms.left.named && arms.right.named;
    const auto lower = [&](const LimbJoints& limb) {
      return limb.end >= 0 ? between(limb.middle, limb.end) : end_site(limb.middle);
    };
    for (const Pair* pair : {&legs, &arms}) {
      const double left = upper(pair->left) + lower(pair->left);
      const double right = upper(pair->right) + lower(pair->right);
      if (std::abs(left - right) > 0.4 * std::max(left, right))
        out.doubt =
            std::string("its two ") + (pair == &legs ? "legs" : "arms") + " are of unequal length";
      if (!named && (pair->left.end < 0 && end_site(pair->left.middle) <= 0))
        out.doubt = "its limbs have no third joint";
    }
    const double leg = upper(legs.left) + lower(legs.left);
    const double trunk = (0.5 * (at(j[16]) + at(j[17])) - 0.5 * (at(j[1]) + at(j[2]))).norm();
    if (!(leg > 0) || !(trunk > 0.15 * leg && trunk < 4 * leg))
      out.doubt = "its trunk and legs have no human proportions";
    if (!named && j[15] < 0) out.doubt = "no head was found";
  }
  double upper(const LimbJoints& limb) const { return between(limb.root, limb.middle); }
  // Along the bones.
  double between(int above, int below) const {
    double sum = 0;
    for (const int joint : path_down(bvh_, above, below)) sum += length(joint);
    return sum;
  }

  const Bvh& bvh_;
  std::vector<JointWord> words_;
  BvhPose pose_;
  std::vector<std::vector<int>> children_;
  std::vector<double> length_, reach_;  // of the bone above a joint; of all that hangs below it
  std::vector<Pair> pairs_;
  bool sided_ = false;  // some names tell left from right
};

}  // namespace

Recognised recognise_body(const Bvh& bvh) {
  return Recogniser(bvh).run();
}

}  // namespace mocaplm
