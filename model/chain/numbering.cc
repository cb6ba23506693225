#include "model/chain/numbering.h"

namespace rigfit::model {
namespace {

/// For each unknown the lowest one that it is coupled with through a segment, joint or support; a
/// mass couples no nodes but those of its segment.
std::vector<int> first_coupled(const Chain& chain, const Numbering& out) {
  std::vector<int> first(at(out.size));
  for (std::size_t k = 0; k < first.size(); ++k) first[k] = static_cast<int>(k);
  std::vector<int> group;
  const auto node = [&](int n) {
    for (int axis = 0; axis < 3; ++axis) group.push_back(out.displacement(axis, n));
  };
  const auto segment = [&](int s) {
    node(chain.segments[at(s)].a);
    node(chain.segments[at(s)].b);
    group.push_back(out.twist[s]);
  };
  const auto rotation = [&](int r) {
    for (int axis = 0; r >= 0 && axis < 3; ++axis) group.push_back(out.rotation(axis, r));
  };
  const auto couple = [&] {
    int low = out.size;
    for (const int i : group) {
      if (i >= 0) low = std::min(low, i);
    }
    for (const int i : group) {
      if (i >= 0) first[at(i)] = std::min(first[at(i)], low);
    }
    group.clear();
  };
  for (int s = 0; s < static_cast<int>(chain.segments.size()); ++s) {
    segment(s);
    couple();
  }
  for (const InnerJoint& joint : chain.inner_joints) {
    segment(joint.segment[0]);
    segment(joint.segment[1]);
    couple();
  }
  for (const EndJoint& joint : chain.end_joints) {
    segment(joint.segment);
    rotation(joint.rotation);
    couple();
  }
  for (const NodeSupport& support : chain.supports) {
    rotation(support.rotation);
    couple();
  }
  return first;
}

/// By rotating node: whether something bears a moment there in the chain's present stage.
std::vector<bool> borne_rotations(const Chain& chain) {
  std::vector<bool> borne(chain.rotating_node.size(), false);
  for (const EndJoint& joint : chain.end_joints) {
    if (joint.rotation < 0 || (joint.stress_free_at_equilibrium && !chain.settled)) continue;
    if (joint.springs.about_1 + joint.springs.about_2 > 0) {
      borne[at(joint.rotation)] = true;
    }
  }
  for (const NodeSupport& support : chain.supports) {
    if (support.rotation >= 0 && support.rotational.maxCoeff() > 0) {
      borne[at(support.rotation)] = true;
    }
  }
  return borne;
}

}  // namespace

Numbering number_unknowns(const Chain& chain, Motion motion) {
  Numbering out;
  out.motion = motion;
  const auto segments = static_cast<Index>(chain.segments.size());
  const auto rotations = static_cast<Index>(chain.rotating_node.size());
  out.displacement.setConstant(3, chain.nodes, -1);
  out.twist.setConstant(segments, -1);
  out.rotation.setConstant(3, rotations, -1);

  const std::vector<bool> borne = borne_rotations(chain);
  const std::vector<int>& order = chain.along;
  std::vector<int> rank(order.size()), rotation(order.size(), -1);
  for (std::size_t k = 0; k < order.size(); ++k) rank[at(order[k])] = static_cast<int>(k);
  for (std::size_t r = 0; r < borne.size(); ++r) {
    if (borne[r]) rotation[at(chain.rotating_node[r])] = static_cast<int>(r);
  }
  // Segments that twist, by the rank of their first node.
  std::vector<std::pair<int, Index>> twisting;
  for (Index s = 0; motion != Motion::in_plane && s < segments; ++s) {
    const Segment& segment = chain.segments[static_cast<std::size_t>(s)];
    const int first = std::min(rank[at(segment.a)], rank[at(segment.b)]);
    if (segment.frame >= 0) twisting.emplace_back(first, s);
  }
  std::ranges::sort(twisting);
  auto next = twisting.begin();
  const bool space = motion == Motion::space, in_plane = motion == Motion::in_plane;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const int node = order[k], r = rotation[at(node)];
    for (int axis = 0; axis < 3; ++axis) {
      const bool here = space || in_plane == (axis < 2);
      if (here && !chain.fixed(axis, node)) out.displacement(axis, node) = out.size++;
    }
    for (int axis = 0; r >= 0 && axis < 3; ++axis) {
      const bool here = space || in_plane == (axis == 2);
      if (here && !chain.rotation_fixed(axis, r)) out.rotation(axis, r) = out.size++;
    }
    for (; next != twisting.end() && next->first == static_cast<int>(k); ++next) {
      out.twist[next->second] = out.size++;
    }
  }
  out.envelope = Envelope::from_rows(first_coupled(chain, out));
  return out;
}

}  // namespace rigfit::model
