#include "worker/optimization/expansion.h"

#include <algorithm>
#include <cstdlib>

namespace depthfarm {
namespace {

int Distance(Level a, Level b) { return std::abs(int{a} - int{b}); }

int DistanceFromInterval(Level alpha, Level a, Level b) {
  const Level low = std::min(a, b);
  const Level high = std::max(a, b);
  if (alpha < low) return low - alpha;
  return alpha > high ? alpha - high : 0;
}

constexpr int kMostThreads = 64;
constexpr int kPartsOfThread = 8;  // a level's work lies in few bands
constexpr int kMostParts = 128;

}  // namespace

Expansion::Expansion(const LabellingProblem& problem, std::vector<Level>& labels, int threads)
    : problem_(problem),
      labels_(labels),
      width_(static_cast<std::size_t>(std::max(problem.matches_per_node, 1))),
      threads_(std::clamp(threads, 1, kMostThreads)),
      held_(problem.num_nodes * width_),
      moves_(problem.num_nodes),
      gathered_(problem.num_nodes, 0) {
  const auto is_free = [&](NodeIndex node) { return problem.fixed[node] == 0; };
  const int num_parts = threads_ > 1 ? std::min(threads_ * kPartsOfThread, kMostParts) : 1;
  if (num_parts > 1) part_of_ = BandsOf(problem, num_parts);
  parts_.resize(static_cast<std::size_t>(num_parts));
  for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].index = i;
  ForParts([&](Part& part) {
    for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
      if (!IsOf(part, node)) continue;
      HoldMatches(node);
      if (is_free(node)) {
        part.free.push_back(node);
        continue;
      }
      const auto held = held_.begin() + static_cast<std::ptrdiff_t>(node * width_);
      const auto rewards_free = [&](const MatchLink& match) { return match.reward != 0 && is_free(match.target); };
      if (std::any_of(held, held + static_cast<std::ptrdiff_t>(width_), rewards_free)) part.rewarding.push_back(node);
    }
  });
  BuildLinks();
  energy_ = TotalEnergy(problem, labels, threads_);
}

void Expansion::BuildLinks() {
  const auto counts = [&](const SmoothnessLink& link) {
    return problem_.fixed[link.first] == 0 || problem_.fixed[link.second] == 0;
  };
  link_begin_.assign(std::size_t{problem_.num_nodes} + 1, 0);
  for (const SmoothnessLink& link : problem_.smoothness) {
    if (!counts(link)) continue;
    ++link_begin_[link.first + 1];
    ++link_begin_[link.second + 1];
  }
  for (std::size_t node = 1; node < link_begin_.size(); ++node) link_begin_[node] += link_begin_[node - 1];
  links_.resize(link_begin_.back());
  std::vector<std::uint32_t> next(link_begin_.begin(), link_begin_.end() - 1);
  for (const SmoothnessLink& link : problem_.smoothness) {
    if (!counts(link)) continue;
    links_[next[link.first]++] = {link.second, link.beta};
    links_[next[link.second]++] = {link.first, link.beta};
  }
}

void Expansion::HoldMatches(NodeIndex node) {
  const auto place = static_cast<Place>(node * width_);
  if (indexed_) {
    for (Place p = place; p < place + width_; ++p) Delist(p);
  }
  std::fill_n(held_.begin() + place, width_, MatchLink{});
  const int level = LevelIndex(problem_, labels_[node]);
  if (level < 0) return;
  Place p = place;
  for (const MatchTable::Match& match : problem_.matches.At(node, static_cast<std::size_t>(level))) {
    held_[p] = {match.target, match.reward};
    if (indexed_) Enlist(p);
    ++p;
  }
}

void Expansion::IndexHolders() {
  indexed_ = true;
  first_holder_.assign(problem_.num_nodes, kNoPlace);
  next_holder_.assign(held_.size(), kNoPlace);
  prior_holder_.assign(held_.size(), kNoPlace);
  for (Place place = 0; place < held_.size(); ++place) {
    if (held_[place].reward != 0) Enlist(place);
  }
  for (Part& part : parts_) part.holders_of_level.assign(problem_.levels.size(), {});
  for (NodeIndex node = 0; node < problem_.num_nodes; ++node) {
    const int level = LevelIndex(problem_, labels_[node]);
    if (level >= 0) PartOf(node).holders_of_level[static_cast<std::size_t>(level)].push_back(node);
  }
}

void Expansion::Enlist(Place place) {
  const NodeIndex target = held_[place].target;
  next_holder_[place] = first_holder_[target];
  prior_holder_[place] = kNoPlace;
  if (first_holder_[target] != kNoPlace) prior_holder_[first_holder_[target]] = place;
  first_holder_[target] = place;
}

void Expansion::Delist(Place place) {
  if (held_[place].reward == 0) return;
  const Place next = next_holder_[place];
  const Place prior = prior_holder_[place];
  if (next != kNoPlace) prior_holder_[next] = prior;
  (prior != kNoPlace ? next_holder_[prior] : first_holder_[held_[place].target]) = next;
}

void Expansion::ChooseMovers(Part& part, std::span<const NodeIndex> nodes, const Move& move) {
  part.movers.clear();
  for (const NodeIndex node : nodes) {
    if (problem_.fixed[node] != 0 || labels_[node] == move.alpha) continue;
    moves_[node].time = time_;
    part.movers.push_back(node);
  }
}

void Expansion::BeginGraph() {
  std::vector<MaxFlow::Node> bounds{0};
  for (Part& part : parts_) {
    part.first = bounds.back();
    bounds.push_back(part.first + static_cast<MaxFlow::Node>(part.movers.size()));
  }
  num_movers_ = bounds.back();
  flow_.Reset(bounds, threads_);
  if (terminal_.size() < bounds.back()) terminal_.resize(bounds.back());  // not less, then more, and zeroed again
  ForParts([&](Part& part) {
    part.shares.clear();
    for (std::size_t i = 0; i < part.movers.size(); ++i) {
      moves_[part.movers[i]].number = part.first + static_cast<MaxFlow::Node>(i);
      terminal_[part.first + i] = 0;
    }
  });
}

void Expansion::AddSmoothness(Part& part, NodeIndex node, const Move& move) {
  const Level s = labels_[node];
  for (std::uint32_t i = link_begin_[node]; i < link_begin_[node + 1]; ++i) {
    const Link& link = links_[i];
    const Level t = labels_[link.other];
    const std::int64_t beta = link.beta;
    const std::int64_t keep_both = beta * Distance(s, t);
    if (!Moves(link.other)) {
      Terminal(node) += beta * Distance(move.alpha, t) - keep_both;
    } else if (node < link.other) {  // once
      const std::int64_t apart = beta * DistanceFromInterval(move.alpha, s, t);
      Terminal(node) += beta * Distance(move.alpha, t) - keep_both - apart;
      AddToTerminal(part, link.other, beta * Distance(s, move.alpha) - keep_both - apart);
      if (apart != 0) flow_.AddEdge(part.index, InGraph(node), InGraph(link.other), static_cast<std::int32_t>(apart));
    }
  }
}

void Expansion::AddMatches(Part& part, NodeIndex node, const Move& move) {
  for (std::size_t slot = 0; slot < width_; ++slot) {
    const MatchLink& keep = held_[node * width_ + slot];
    if (keep.reward == 0 || labels_[keep.target] != labels_[node]) continue;
    const std::int32_t reward = keep.RewardUnits();
    if (!Moves(keep.target)) {
      Terminal(node) += reward;  // lost when the node leaves
    } else {
      Terminal(node) += reward / 2;
      AddToTerminal(part, keep.target, reward / 2);
      flow_.AddEdge(part.index, InGraph(node), InGraph(keep.target), reward / 2);
    }
  }
  for (const MatchTable::Match& take : problem_.matches.At(node, move.level)) {
    const std::int32_t reward = take.RewardUnits();
    if (labels_[take.target] == move.alpha) {
      Terminal(node) -= reward;
    } else if (Moves(take.target)) {
      Terminal(node) -= reward / 2;
      AddToTerminal(part, take.target, -(reward / 2));
      flow_.AddEdge(part.index, InGraph(node), InGraph(take.target), reward / 2);
    }
  }
}

void Expansion::AddMatchOfConstant(Part& part, NodeIndex node, const MatchLink& match, const Move& move) {
  if (match.reward == 0 || !Moves(match.target)) return;
  if (labels_[node] == move.alpha) {
    AddToTerminal(part, match.target, -match.RewardUnits());
  } else if (labels_[match.target] == labels_[node]) {
    AddToTerminal(part, match.target, match.RewardUnits());
  }
}

std::int64_t Expansion::Solve(const Move& move) {
  for (const Part& part : parts_)
    for (const Share& share : part.shares) terminal_[share.node] += share.weight;
  // Least E - E(keep all) = (sum of the negative linear coefficients) + maximum flow.
  std::int64_t delta = 0;
  for (std::size_t i = 0; i < num_movers_; ++i) {
    if (terminal_[i] < 0) delta += terminal_[i];
    if (terminal_[i] != 0) flow_.AddTerminal(static_cast<MaxFlow::Node>(i), -terminal_[i]);
  }
  if (delta == 0) return 0;
  delta += flow_.Solve(threads_);
  if (delta == 0) return 0;
  for (Part& part : parts_) {
    for (std::size_t i = 0; i < part.movers.size(); ++i) {
      if (!flow_.InSourceSide(part.first + static_cast<MaxFlow::Node>(i))) continue;
      const NodeIndex node = part.movers[i];
      labels_[node] = move.alpha;
      HoldMatches(node);
      if (indexed_) part.holders_of_level[move.level].push_back(node);
    }
  }
  energy_ += delta;
  return delta;
}

std::int64_t Expansion::Expand(std::size_t level) {
  const Move move{level, problem_.levels[level]};
  ++time_;
  ForParts([&](Part& part) { ChooseMovers(part, part.free, move); });
  BeginGraph();
  ForParts([&](Part& part) {
    for (const NodeIndex node : part.movers) {
      AddSmoothness(part, node, move);
      AddMatches(part, node, move);
    }
    const auto add_constant = [&](NodeIndex node) {
      for (std::size_t slot = 0; slot < width_; ++slot)
        AddMatchOfConstant(part, node, held_[node * width_ + slot], move);
    };
    for (const NodeIndex node : part.free) {
      if (labels_[node] == move.alpha) add_constant(node);
    }
    for (const NodeIndex node : part.rewarding) add_constant(node);
  });
  return Solve(move);
}

void Expansion::GatherNear(Part& part, const Move& move, std::size_t band) {
  part.near.clear();
  part.near_elsewhere.clear();
  const std::size_t end = std::min(move.level + band + 1, problem_.levels.size());
  for (std::size_t level = move.level - std::min(band, move.level); level < end; ++level) {
    std::vector<NodeIndex>& holders = part.holders_of_level[level];
    std::size_t kept = 0;
    for (const NodeIndex node : holders) {
      if (labels_[node] != problem_.levels[level] || gathered_[node] == time_) continue;  // left, or came twice
      Gather(part, node);
      holders[kept++] = node;
    }
    holders.resize(kept);
  }
  const auto gather = [&](NodeIndex node) {
    if (IsOf(part, node)) {
      Gather(part, node);
    } else {
      part.near_elsewhere.push_back(node);
    }
  };
  const std::size_t seeds = part.near.size();
  for (std::size_t i = 0; i < seeds; ++i) {
    const NodeIndex node = part.near[i];
    for (std::uint32_t link = link_begin_[node]; link < link_begin_[node + 1]; ++link) gather(links_[link].other);
    for (const MatchTable::Match& match : problem_.matches.At(node, move.level)) gather(match.target);
  }
}

void Expansion::GatherFromOthers(Part& part) {
  for (const Part& other : parts_) {
    for (const NodeIndex node : other.near_elsewhere)
      if (IsOf(part, node)) Gather(part, node);
  }
}

std::int64_t Expansion::ExpandNear(std::size_t level, std::size_t band) {
  const Move move{level, problem_.levels[level]};
  if (!indexed_) IndexHolders();
  ++time_;
  ForParts([&](Part& part) { GatherNear(part, move, band); });
  ForParts([&](Part& part) {
    GatherFromOthers(part);
    // Neighbours in the graph lie near each other in memory then; no cut depends on it.
    std::sort(part.near.begin(), part.near.end());
  });
  return MoveGathered(move);
}

std::int64_t Expansion::ExpandAmong(std::size_t level, std::span<const NodeIndex> nodes) {
  const Move move{level, problem_.levels[level]};
  if (!indexed_) IndexHolders();
  ++time_;
  ForParts([&](Part& part) {
    part.near.clear();
    for (const NodeIndex node : nodes)
      if (IsOf(part, node)) part.near.push_back(node);
  });
  return MoveGathered(move);
}

std::int64_t Expansion::MoveGathered(const Move& move) {
  ForParts([&](Part& part) { ChooseMovers(part, part.near, move); });
  BeginGraph();
  ForParts([&](Part& part) {
    for (const NodeIndex node : part.movers) {
      AddSmoothness(part, node, move);
      AddMatches(part, node, move);
      for (Place place = first_holder_[node]; place != kNoPlace; place = next_holder_[place]) {
        if (!Moves(HolderOf(place))) AddMatchOfConstant(part, HolderOf(place), held_[place], move);
      }
    }
  });
  return Solve(move);
}

}  // namespace depthfarm
