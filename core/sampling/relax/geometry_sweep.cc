#include <algorithm>
#include <array>
#include <vector>

#include "core/sampling/relax/geometry_phase.h"
#include "core/sampling/relax/ring.h"
#include "core/sampling/relax/ring_batch.h"

// How GeometryPhase goes through the samples: in blocks side by side, eight at a time in each.

namespace ccst::internal {
namespace {

/// Fewer samples are one block: they are not worth several threads.
constexpr std::int32_t kLeastForBlocks = 32768;

/// Units of work, for an Interrupt, of looking for a sample's neighbours and of moving it: a move
/// may cross many thin faces.
constexpr std::int64_t kGatherWork = 4;
constexpr std::int64_t kVisitWork = 32;

/// Blocks that become one of the next level.
constexpr std::size_t kFan = 4;

/// Vertices of a block: enough that few lie between blocks, few enough that there are many blocks.
/// Of the number of samples alone, for the order of the visits follows from it.
std::int32_t BlockSize(std::int32_t count) {
  return count < kLeastForBlocks ? count : std::clamp(count / 12, 1024, 3072);
}

}  // namespace

GeometryPhase::Levels GeometryPhase::MakeLevels(bool shifted) {
  Levels levels;
  const std::int64_t count = samples_.count();
  std::int64_t size = std::max(1, BlockSize(samples_.count()));
  const std::int64_t shift = shifted && size < count ? size / 2 : 0;
  do {
    std::vector<Block>& blocks = levels.emplace_back();
    for (std::int64_t first = -shift; first < count; first += size) {
      const auto begin = static_cast<std::int32_t>(std::max<std::int64_t>(first, 0));
      const auto end = static_cast<std::int32_t>(std::min(first + size, count));
      blocks.emplace_back(begin, end, packed_.MakeFlips());
    }
    size *= kFan;
  } while (levels.back().size() > 1);
  return levels;
}

void GeometryPhase::VisitTogether(Batch* batch, Ring* ring, Block* block) {
  if (HasNeighbours(packed_.rings().data(), registers_, *batch)) {
    for (const std::int32_t v : batch->vertex) VisitAlone(v, ring, block);
    return;
  }
  for (int k = 0; k < Batch::kSize; ++k) {
    batch->scale[k] = static_cast<float>(0.5 * scale_[samples_.component[batch->vertex[k]]]);
  }
  const BatchSources sources = {.places = packed_.places().data(),
                                .normals = packed_.normals().data(),
                                .rings = packed_.rings().data(),
                                .valences = packed_.valences().data(),
                                .faces = samples_.face.data(),
                                .weights = samples_.weights.data(),
                                .corners = surface_.faces().data(),
                                .vertices = hosts_.data(),
                                .surface = &surface_,
                                .densities = mean_density_.empty() ? nullptr : mean_density_.data(),
                                .triangles = packed_.triangles().data(),
                                .energy = energy_,
                                .stretch = static_cast<float>(stretch),
                                .longest = static_cast<float>(kLongestStep),
                                .least = static_cast<float>(kLeastStep * rest)};
  Step(sources, registers_, batch);
  for (int k = 0; k < Batch::kSize; ++k) {
    const std::int32_t v = batch->vertex[k];
    if ((batch->settled >> k & 1) == 0) continue;
    if (batch->spoilt[k] != 0) {
      std::array<int, SmallRing::kMost> spokes;
      int count = 0;
      for (int i = 0; i < SmallRing::kMost; ++i) {
        if ((batch->spoilt[k] >> i & 1) != 0) spokes[count++] = i;
      }
      AddSpokes(v, spokes.data(), count, &block->spoilt_edges);
    }
    if ((batch->moves >> k & 1) == 0) continue;
    const double* position = batch->position[k];
    const double* weights = batch->weights[k];
    packed_.Move(v,
                 {.face = batch->face[k],
                  .weights = {weights[0], weights[1], weights[2]},
                  .position = {position[0], position[1], position[2]}},
                 {batch->normal[0][k], batch->normal[1][k], batch->normal[2][k]});
    NoteMove(v, batch->move[k], packed_.rings()[v].vertex, packed_.valences()[v], block);
  }
  for (int k = 0; k < Batch::kSize; ++k) {
    if ((batch->settled >> k & 1) == 0) VisitAlone(batch->vertex[k], ring, block);
  }
}

void GeometryPhase::VisitBlock(Block* block, Scratch* scratch, Interrupt* interrupt) {
  block->waiting.clear();
  std::vector<std::int32_t>& plain = scratch->plain;
  plain.clear();
  const auto is_inside = [&](const std::int32_t* vertices, int count) {
    return std::all_of(vertices, vertices + count,
                       [&](std::int32_t u) { return u >= block->first && u < block->end; });
  };
  Ring& ring = scratch->ring;
  for (const std::int32_t v : scratch->candidates) {
    if (interrupt->RequestedAfter(kGatherWork)) return;
    if (packed_.LearnRing(v)) {
      if (is_inside(packed_.rings()[v].vertex, SmallRing::kMost)) {
        active_[v] = 0;
        plain.push_back(v);
      } else {
        block->waiting.push_back(v);
      }
    } else if (Gather(v, &ring)) {
      if (is_inside(ring.vertex.data(), ring.neighbours)) {
        if (interrupt->RequestedAfter(kVisitWork)) return;
        active_[v] = 0;
        Visit(v, &ring, block);
      } else {
        block->waiting.push_back(v);
      }
    }
  }
  // One from each eighth: these are hardly ever neighbours.
  const std::size_t stride = plain.size() / Batch::kSize;
  Batch batch;
  for (std::size_t i = 0; i < stride; ++i) {
    if (interrupt->RequestedAfter(Batch::kSize * kVisitWork)) return;
    for (int k = 0; k < Batch::kSize; ++k) batch.vertex[k] = plain[i + k * stride];
    VisitTogether(&batch, &ring, block);
  }
  for (std::size_t i = Batch::kSize * stride; i < plain.size(); ++i) {
    if (interrupt->RequestedAfter(kVisitWork)) return;
    VisitAlone(plain[i], &ring, block);
  }
}

void GeometryPhase::FlipBlock(Block* block, Interrupt* interrupt) {
  block->flips.touched.clear();
  block->flips.beyond.clear();
  block->change.flips += block->flips.FlipThese(block->spoilt_edges, interrupt);
  for (const std::int32_t v : block->flips.touched) {
    moved_[v] = 1;
    ActivateFlipped(v);
  }
  block->spoilt_edges.swap(block->flips.beyond);
}

void GeometryPhase::FindCandidates(const Levels& levels, std::size_t level, std::size_t b,
                                   std::vector<std::int32_t>* candidates) const {
  candidates->clear();
  const auto add = [&](std::int32_t v) {
    if (active_[v] && samples_.kind[v] != SampleMesh::Kind::kFixed) candidates->push_back(v);
  };
  const Block& block = levels[level][b];
  if (level == 0) {
    for (std::int32_t v = block.first; v < block.end; ++v) add(v);
    return;
  }
  const std::vector<Block>& parts = levels[level - 1];
  for (std::size_t i = kFan * b; i < std::min(kFan * (b + 1), parts.size()); ++i) {
    for (const std::int32_t v : parts[i].waiting) add(v);
  }
}

GeometryPhase::Change GeometryPhase::Sweep(int passes, bool flip, Interrupt* interrupt) {
  Change change;
  Levels& levels = levels_[sweeps_++ % 2];
  for (std::size_t level = 0; level < levels.size(); ++level) {
    std::vector<Block>& blocks = levels[level];
    parallel_.For(static_cast<std::int64_t>(blocks.size()), [&, stop = *interrupt](std::int64_t b) {
      Block& block = blocks[static_cast<std::size_t>(b)];
      block.change = {};
      block.waiting.clear();
      block.spoilt_edges.clear();
      if (level > 0) {
        const std::vector<Block>& parts = levels[level - 1];
        const std::size_t first = kFan * static_cast<std::size_t>(b);
        for (std::size_t i = first; i < std::min(first + kFan, parts.size()); ++i) {
          block.spoilt_edges.insert(block.spoilt_edges.end(), parts[i].spoilt_edges.begin(),
                                    parts[i].spoilt_edges.end());
        }
      }
      Interrupt own(stop);
      Scratch scratch;
      for (int pass = 0; pass < passes && !own.Requested(); ++pass) {
        FindCandidates(levels, level, static_cast<std::size_t>(b), &scratch.candidates);
        VisitBlock(&block, &scratch, &own);
        if (flip) FlipBlock(&block, &own);
      }
    });
    for (const Block& block : blocks) {
      change.largest_move = std::max(change.largest_move, block.change.largest_move);
      change.flips += block.change.flips;
    }
  }
  spoilt_edges_ = levels.back().front().spoilt_edges;
  return change;
}

}  // namespace ccst::internal
