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

}  // namespace

Expansion::Expansion(const LabellingProblem& problem, std::vector<Level>& labels)
    : problem_(problem),
      labels_(labels),
      width_(static_cast<std::size_t>(std::max(problem.matches_per_node, 1))),
      held_(problem.num_nodes * width_),
      moves_(problem.num_nodes, 0),
      gathered_(problem.num_nodes, 0),
      in_graph_(problem.num_nodes) {
  const auto is_free = [&](NodeIndex node) { return problem.fixed[node] == 0; };
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    HoldMatches(node);
    if (is_free(node)) {
      free_.push_back(node);
      continue;
    }
    const auto held = held_.begin() + static_cast<std::ptrdiff_t>(node * width_);
    const auto rewards_free = [&](const MatchLink& match) { return match.reward != 0 && is_free(match.target); };
    if (std::any_of(held, held + static_cast<std::ptrdiff_t>(width_), rewards_free)) rewarding_.push_back(node);
  }
  BuildLinks();
  energy_ = TotalEnergy(problem, labels);
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
  holders_of_level_.assign(problem_.levels.size(), {});
  for (NodeIndex node = 0; node < problem_.num_nodes; ++node) {
    const int level = LevelIndex(problem_, labels_[node]);
    if (level >= 0) holders_of_level_[static_cast<std::size_t>(level)].push_back(node);
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

void Expansion::BeginGraph(std::span<const NodeIndex> nodes, const Move& move) {
  movers_.clear();
  for (const NodeIndex node : nodes) {
    if (problem_.fixed[node] != 0 || labels_[node] == move.alpha) continue;
    moves_[node] = time_;
    in_graph_[node] = static_cast<MaxFlow::Node>(movers_.size());
    movers_.push_back(node);
  }
  flow_.Reset(static_cast<MaxFlow::Node>(movers_.size()));
  terminal_.assign(movers_.size(), 0);
}

void Expansion::AddSmoothness(NodeIndex node, const Move& move) {
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
      Terminal(link.other) += beta * Distance(s, move.alpha) - keep_both - apart;
      if (apart != 0) flow_.AddEdge(InGraph(node), InGraph(link.other), static_cast<std::int32_t>(apart));
    }
  }
}

void Expansion::AddMatches(NodeIndex node, const Move& move) {
  for (std::size_t slot = 0; slot < width_; ++slot) {
    const MatchLink& keep = held_[node * width_ + slot];
    if (keep.reward == 0 || labels_[keep.target] != labels_[node]) continue;
    const std::int32_t reward = keep.RewardUnits();
    if (!Moves(keep.target)) {
      Terminal(node) += reward;  // lost when the node leaves
    } else {
      Terminal(node) += reward / 2;
      Terminal(keep.target) += reward / 2;
      flow_.AddEdge(InGraph(node), InGraph(keep.target), reward / 2);
    }
  }
  for (const MatchTable::Match& take : problem_.matches.At(node, move.level)) {
    const std::int32_t reward = take.RewardUnits();
    if (labels_[take.target] == move.alpha) {
      Terminal(node) -= reward;
    } else if (Moves(take.target)) {
      Terminal(node) -= reward / 2;
      Terminal(take.target) -= reward / 2;
      flow_.AddEdge(InGraph(node), InGraph(take.target), reward / 2);
    }
  }
}

void Expansion::AddMatchOfConstant(NodeIndex node, const MatchLink& match, const Move& move) {
  if (match.reward == 0 || !Moves(match.target)) return;
  if (labels_[node] == move.alpha) {
    Terminal(match.target) -= match.RewardUnits();
  } else if (labels_[match.target] == labels_[node]) {
    Terminal(match.target) += match.RewardUnits();
  }
}

std::int64_t Expansion::Solve(const Move& move) {
  // Least E - E(keep all) = (sum of the negative linear coefficients) + maximum flow.
  std::int64_t delta = 0;
  for (std::size_t i = 0; i < terminal_.size(); ++i) {
    if (terminal_[i] < 0) delta += terminal_[i];
    if (terminal_[i] != 0) flow_.AddTerminal(static_cast<MaxFlow::Node>(i), -terminal_[i]);
  }
  if (delta == 0) return 0;
  delta += flow_.Solve();
  if (delta == 0) return 0;
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    if (!flow_.InSourceSide(static_cast<MaxFlow::Node>(i))) continue;
    labels_[movers_[i]] = move.alpha;
    HoldMatches(movers_[i]);
    if (indexed_) holders_of_level_[move.level].push_back(movers_[i]);
  }
  energy_ += delta;
  return delta;
}

std::int64_t Expansion::Expand(std::size_t level) {
  const Move move{level, problem_.levels[level]};
  ++time_;
  BeginGraph(free_, move);
  for (const NodeIndex node : movers_) {
    AddSmoothness(node, move);
    AddMatches(node, move);
  }
  const auto add_constant = [&](NodeIndex node) {
    for (std::size_t slot = 0; slot < width_; ++slot) AddMatchOfConstant(node, held_[node * width_ + slot], move);
  };
  for (const NodeIndex node : free_) {
    if (labels_[node] == move.alpha) add_constant(node);
  }
  for (const NodeIndex node : rewarding_) add_constant(node);
  return Solve(move);
}

void Expansion::GatherNear(const Move& move, std::size_t band) {
  near_.clear();
  const std::size_t end = std::min(move.level + band + 1, problem_.levels.size());
  for (std::size_t level = move.level - std::min(band, move.level); level < end; ++level) {
    std::vector<NodeIndex>& holders = holders_of_level_[level];
    std::size_t kept = 0;
    for (const NodeIndex node : holders) {
      if (labels_[node] != problem_.levels[level] || gathered_[node] == time_) continue;  // left, or came twice
      Gather(node);
      holders[kept++] = node;
    }
    holders.resize(kept);
  }
  const std::size_t seeds = near_.size();
  for (std::size_t i = 0; i < seeds; ++i) {
    const NodeIndex node = near_[i];
    for (std::uint32_t link = link_begin_[node]; link < link_begin_[node + 1]; ++link) Gather(links_[link].other);
    for (const MatchTable::Match& match : problem_.matches.At(node, move.level)) Gather(match.target);
  }
  std::sort(near_.begin(), near_.end());  // neighbours in the graph lie near each other in memory; no cut depends on it
}

std::int64_t Expansion::ExpandNear(std::size_t level, std::size_t band) {
  const Move move{level, problem_.levels[level]};
  if (!indexed_) IndexHolders();
  ++time_;
  GatherNear(move, band);
  return MoveSome(near_, move);
}

std::int64_t Expansion::ExpandAmong(std::size_t level, std::span<const NodeIndex> nodes) {
  const Move move{level, problem_.levels[level]};
  if (!indexed_) IndexHolders();
  ++time_;
  return MoveSome(nodes, move);
}

std::int64_t Expansion::MoveSome(std::span<const NodeIndex> nodes, const Move& move) {
  BeginGraph(nodes, move);
  for (const NodeIndex node : movers_) {
    AddSmoothness(node, move);
    AddMatches(node, move);
    for (Place place = first_holder_[node]; place != kNoPlace; place = next_holder_[place]) {
      if (!Moves(HolderOf(place))) AddMatchOfConstant(HolderOf(place), held_[place], move);
    }
  }
  return Solve(move);
}

}  // namespace depthfarm
