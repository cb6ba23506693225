#include "model/chain/numbering.h"

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

namespace rigfit::model {
namespace {

/// Rank of each node in a breadth-first walk from a node at the rig's edge: neighbours get near
/// ranks (E. Cuthill and J. McKee, Proc. 24th ACM Nat. Conf., 1969).
std::vector<int> walk(const Chain& chain) {
  const auto n = static_cast<std::size_t>(chain.nodes);
  std::vector<int> begin(n + 1, 0), neighbour(2 * chain.segments.size());
  for (const Segment& s : chain.segments) {
    ++begin[static_cast<std::size_t>(s.a) + 1];
    ++begin[static_cast<std::size_t>(s.b) + 1];
  }
  for (std::size_t k = 0; k < n; ++k) begin[k + 1] += begin[k];
  std::vector<int> fill(begin.begin(), begin.end() - 1);
  for (const Segment& s : chain.segments) {
    neighbour[static_cast<std::size_t>(fill[static_cast<std::size_t>(s.a)]++)] = s.b;
    neighbour[static_cast<std::size_t>(fill[static_cast<std::size_t>(s.b)]++)] = s.a;
  }
  std::vector<int> rank(n, -1), order;
  order.reserve(n);
  const auto breadth_first = [&](int start, std::vector<int>& mark) {
    order.clear();
    order.push_back(start);
    mark[static_cast<std::size_t>(start)] = 0;
    for (std::size_t head = 0; head < order.size(); ++head) {
      const auto here = static_cast<std::size_t>(order[head]);
      for (int p = begin[here]; p < begin[here + 1]; ++p) {
        const int next = neighbour[static_cast<std::size_t>(p)];
        if (mark[static_cast<std::size_t>(next)] >= 0) continue;
        mark[static_cast<std::size_t>(next)] = 0;
        order.push_back(next);
      }
    }
  };
  int next_rank = 0;
  std::vector<int> mark(n, -1);
  for (int start = 0; start < chain.nodes; ++start) {
    if (rank[static_cast<std::size_t>(start)] >= 0) continue;
    int edge = start;
    for (int sweep = 0; sweep < 2; ++sweep) {  // the farthest node of the farthest
      breadth_first(edge, mark);
      edge = order.back();
      for (const int node : order) mark[static_cast<std::size_t>(node)] = -1;
    }
    breadth_first(edge, mark);
    for (const int node : order) rank[static_cast<std::size_t>(node)] = next_rank++;
  }
  return rank;
}

/// For each unknown the lowest one that it is coupled with through a segment, joint or support; a
/// mass couples no nodes but those of its segment.
std::vector<int> first_coupled(const Chain& chain, const Numbering& out) {
  std::vector<int> first(static_cast<std::size_t>(out.size));
  for (std::size_t k = 0; k < first.size(); ++k) first[k] = static_cast<int>(k);
  std::vector<int> group;
  const auto node = [&](int n) {
    for (int axis = 0; axis < 3; ++axis) group.push_back(out.displacement(axis, n));
  };
  const auto segment = [&](int s) {
    node(chain.segments[static_cast<std::size_t>(s)].a);
    node(chain.segments[static_cast<std::size_t>(s)].b);
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
      if (i >= 0)
        first[static_cast<std::size_t>(i)] = std::min(first[static_cast<std::size_t>(i)], low);
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
      borne[static_cast<std::size_t>(joint.rotation)] = true;
    }
  }
  for (const NodeSupport& support : chain.supports) {
    if (support.rotation >= 0 && support.rotational.maxCoeff() > 0) {
      borne[static_cast<std::size_t>(support.rotation)] = true;
    }
  }
  return borne;
}

}  // namespace

Numbering number_unknowns(const Chain& chain, Motion motion) {
  Numbering out;
  out.motion = motion;
  const auto segments = static_cast<Eigen::Index>(chain.segments.size());
  const auto rotations = static_cast<Eigen::Index>(chain.rotating_node.size());
  out.displacement.setConstant(3, chain.nodes, -1);
  out.twist.setConstant(segments, -1);
  out.rotation.setConstant(3, rotations, -1);

  const std::vector<bool> borne = borne_rotations(chain);

  struct Unknown {
    int nodes[2];  // it stands behind the lower one
    int kind;
    int* number;
    long key = 0;
  };
  std::vector<Unknown> unknowns;
  unknowns.reserve(static_cast<std::size_t>(3 * chain.nodes));
  const auto add = [&](int a, int b, int kind, int& number) {
    number = 0;
    unknowns.push_back({{a, b}, kind, &number});
  };
  const auto wanted = [motion](int axis) {
    return motion == Motion::space || (motion == Motion::in_plane ? axis < 2 : axis == 2);
  };
  for (int node = 0; node < chain.nodes; ++node) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!wanted(axis) || chain.fixed(axis, node)) continue;
      add(node, node, 1, out.displacement(axis, node));
    }
  }
  for (Eigen::Index r = 0; r < rotations; ++r) {
    const auto k = static_cast<std::size_t>(r);
    if (!borne[k]) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const bool here = motion == Motion::space || (motion == Motion::in_plane) == (axis == 2);
      if (!here || chain.rotation_fixed(axis, r)) continue;
      add(chain.rotating_node[k], chain.rotating_node[k], 2, out.rotation(axis, r));
    }
  }
  if (motion != Motion::in_plane) {
    for (Eigen::Index s = 0; s < segments; ++s) {
      const Segment& segment = chain.segments[static_cast<std::size_t>(s)];
      if (segment.frame >= 0) add(segment.a, segment.b, 3, out.twist[s]);
    }
  }
  const std::vector<int> rank = walk(chain);
  const auto rank_of = [&](int node) { return rank[static_cast<std::size_t>(node)]; };
  for (Unknown& x : unknowns) {
    x.key = 4L * std::min(rank_of(x.nodes[0]), rank_of(x.nodes[1])) + x.kind;
  }
  std::stable_sort(unknowns.begin(), unknowns.end(),
                   [](const Unknown& x, const Unknown& y) { return x.key < y.key; });
  out.size = static_cast<int>(unknowns.size());
  for (std::size_t k = 0; k < unknowns.size(); ++k) *unknowns[k].number = static_cast<int>(k);
  out.envelope = Envelope::from_rows(first_coupled(chain, out));
  return out;
}

}  // namespace rigfit::model
