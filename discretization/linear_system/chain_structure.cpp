#include "discretization/linear_system/chain_structure.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace mixbeam {

namespace {

/// Links per run: long enough that the matrices of the runs cost little, short enough that a thousand elements still
/// fill the lanes of all threads.
constexpr int kRunLength = 32;
/// Least number of runs of a chain that is cut: fills the lanes of a register.
constexpr int kLeastRuns = 4;
/// Chains up to this length are one run.
constexpr int kShortChain = 8;

int number_of_runs(int links) {
  if (links <= kShortChain) return 1;
  return std::max(kLeastRuns, (links + kRunLength - 1) / kRunLength);
}

/// Elements at each vertex; at most two are stored, more make a junction.
struct Touching {
  int count = 0;
  int element[2] = {-1, -1};
};

}  // namespace

ChainStructure::ChainStructure(const std::vector<std::array<int, 2>>& ends, std::vector<unsigned char> kept) {
  levels_.elements = static_cast<int>(ends.size());
  std::vector<Chain> chains = trace(ends, kept);
  eliminated_.assign(kept.size(), 0);
  for (const Chain& chain : chains)
    for (size_t i = 1; i + 1 < chain.vertices.size(); ++i) eliminated_[chain.vertices[i]] = 1;
  eliminated_vertices_ = std::accumulate(eliminated_.begin(), eliminated_.end(), 0);
  std::vector<int> lowest;
  for (const Chain& chain : chains) lowest.push_back(*std::min_element(chain.links.begin(), chain.links.end()) / 2);
  while (std::any_of(chains.begin(), chains.end(), [](const Chain& c) { return c.links.size() > 1; }))
    add_level(chains);
  for (size_t c = 0; c < chains.size(); ++c) {
    const bool turned = chains[c].links[0] % 2 == 1;  // a single element, traversed backwards
    const int a = chains[c].vertices.front(), b = chains[c].vertices.back();
    remaining_.push_back({chains[c].links[0] / 2, lowest[c], {turned ? b : a, turned ? a : b}});
  }
  std::sort(remaining_.begin(), remaining_.end(),
            [](const RemainingLink& a, const RemainingLink& b) { return a.first_element < b.first_element; });
}

/// Traces chains between kept vertices; every element is in one. A ring without any such vertex keeps one.
std::vector<ChainStructure::Chain> ChainStructure::trace(const std::vector<std::array<int, 2>>& ends,
                                                         std::vector<unsigned char>& kept) const {
  std::vector<Touching> touching(kept.size());
  for (int e = 0; e < levels_.elements; ++e)
    for (int vertex : ends[e]) {
      Touching& t = touching[vertex];
      if (t.count < 2) t.element[t.count] = e;
      ++t.count;
    }
  for (size_t v = 0; v < kept.size(); ++v)
    if (touching[v].count != 2 || touching[v].element[0] == touching[v].element[1]) kept[v] = 1;
  std::vector<Chain> chains;
  std::vector<unsigned char> taken(ends.size(), 0);
  const auto follow = [&](int element, int end) {
    Chain chain;
    chain.vertices.push_back(ends[element][end]);
    for (;;) {
      taken[element] = 1;
      chain.links.push_back(2 * element + end);
      const int vertex = ends[element][1 - end];
      chain.vertices.push_back(vertex);
      if (kept[vertex]) break;
      const Touching& t = touching[vertex];
      element = t.element[0] == element ? t.element[1] : t.element[0];
      end = ends[element][0] == vertex ? 0 : 1;
    }
    chains.push_back(std::move(chain));
  };
  for (int e = 0; e < levels_.elements; ++e)
    for (int end = 0; end < 2; ++end)
      if (!taken[e] && kept[ends[e][end]]) follow(e, end);
  for (int e = 0; e < levels_.elements; ++e) {
    if (taken[e]) continue;
    kept[ends[e][0]] = 1;
    follow(e, 0);
  }
  return chains;
}

/// Cuts every chain of more than one link into runs of nearly equal length and replaces each run by a link.
void ChainStructure::add_level(std::vector<Chain>& chains) {
  std::vector<Run> runs;
  const int first_run = levels_.runs;
  std::vector<Chain> shorter(chains.size());
  for (size_t c = 0; c < chains.size(); ++c) {
    const int links = static_cast<int>(chains[c].links.size());
    if (links == 1) {
      shorter[c] = chains[c];
      continue;
    }
    const int count = number_of_runs(links);
    shorter[c].vertices.push_back(chains[c].vertices[0]);
    for (int r = 0; r < count; ++r) {
      const int begin = static_cast<int>(static_cast<long>(links) * r / count);
      const int end = static_cast<int>(static_cast<long>(links) * (r + 1) / count);
      runs.push_back({static_cast<int>(c), begin, end});
      shorter[c].links.push_back(2 * (levels_.elements + levels_.runs++));
      shorter[c].vertices.push_back(chains[c].vertices[end]);
    }
  }
  levels_.levels.push_back(pack(chains, runs, first_run));
  chains = std::move(shorter);
}

/// Packs runs of nearly equal length side by side.
ChainLevel ChainStructure::pack(const std::vector<Chain>& chains, const std::vector<Run>& runs, int first_run) const {
  std::vector<int> order(runs.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return runs[a].length() > runs[b].length(); });
  ChainLevel level;
  level.packs = static_cast<int>((runs.size() + kLanes - 1) / kLanes);
  level.step_start = KernelView<int*>("mixbeam::chains::step_start", level.packs + 1);
  for (int p = 0; p < level.packs; ++p)
    level.step_start(p + 1) = level.step_start(p) + runs[order[static_cast<size_t>(p) * kLanes]].length();
  const int steps = level.step_start(level.packs);
  level.link = KernelView<int* [kLanes]>("mixbeam::chains::link", steps);
  level.vertex = KernelView<int* [kLanes]>("mixbeam::chains::vertex", steps);
  level.first_vertex = KernelView<int* [kLanes]>("mixbeam::chains::first_vertex", level.packs);
  level.run = KernelView<int* [kLanes]>("mixbeam::chains::run", level.packs);
  level.links = KernelView<int* [kLanes]>("mixbeam::chains::links", level.packs);
  for (int p = 0; p < level.packs; ++p)
    for (int lane = 0; lane < kLanes; ++lane) {
      const size_t slot = static_cast<size_t>(p) * kLanes + lane;
      const bool present = slot < order.size();
      const Run run = present ? runs[order[slot]] : Run();
      level.run(p, lane) = present ? first_run + order[slot] : -1;
      level.links(p, lane) = run.length();
      level.first_vertex(p, lane) = present ? chains[run.chain].vertices[run.begin] : -1;
      for (int s = level.step_start(p); s < level.step_start(p + 1); ++s) {
        const int link = run.begin + s - level.step_start(p);
        level.link(s, lane) = link < run.end ? chains[run.chain].links[link] : -1;
        level.vertex(s, lane) = present ? chains[run.chain].vertices[std::min(link + 1, run.end)] : -1;
      }
    }
  return level;
}

}  // namespace mixbeam
