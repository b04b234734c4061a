// Which edge next? Free triangles before connections inside a working area (sec. 3), the rounder triangle first within a
// class, ties by birth: the order is a function of the input and the parameters alone.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/front/front_set.h"

namespace meshfront {

enum class AgendaStage : uint8_t {
  kFree,     // try a free triangle
  kSearch,   // look for the best connection
  kConnect,  // make the connection found
};

// A heap of (stage, ratio, birth). Stale entries are recognised by their ticket, not searched for.
class Agenda {
 public:
  struct Entry {
    uint64_t rank;  // greater is better: stage, ratio, birth in one number
    FrontEdgeId edge;
    uint32_t ticket;

    AgendaStage stage() const { return static_cast<AgendaStage>(3 - (rank >> 62)); }
  };

  // `ratio` in [0, 2): greater is better.
  void Push(AgendaStage stage, double ratio, uint32_t birth, FrontEdgeId edge) {
    heap_.push_back({RankOf(stage, static_cast<float>(ratio), birth), edge, ++TicketOf(edge)});
    RiseFrom(heap_.size() - 1, heap_.back());
  }
  // Forgets what is on the agenda for the edge: it is gone, or left the working area.
  void Cancel(FrontEdgeId edge) { ++TicketOf(edge); }
  // Nothing is left, not even what no longer counts.
  bool empty() const { return heap_.empty(); }
  // The next entry that still counts; false when there is none.
  bool Pop(Entry& entry) {
    while (!heap_.empty()) {
      entry = heap_.front();
      DropFirst();
      if (entry.ticket == TicketOf(entry.edge)) return true;
    }
    return false;
  }

 private:
  // Puts an entry where it belongs between a hole at `at` and the top.
  void RiseFrom(size_t at, const Entry entry) {
    for (; at > 0 && heap_[(at - 1) / 2].rank < entry.rank; at = (at - 1) / 2) heap_[at] = heap_[(at - 1) / 2];
    heap_[at] = entry;
  }
  // The hole sinks to the bottom, always to the greater child and without branches; from there the last entry rises.
  void DropFirst() {
    const Entry last = heap_.back();
    heap_.pop_back();
    const size_t size = heap_.size();
    if (size == 0) return;
    size_t hole = 0, child = 1;
    for (; child + 1 < size; child = 2 * hole + 1) {
      child += heap_[child + 1].rank > heap_[child].rank;
      heap_[hole] = heap_[child];
      hole = child;
    }
    if (child < size) heap_[hole] = heap_[child], hole = child;
    RiseFrom(hole, last);
  }
  // Floats that are not negative are ordered as their bits are; below 2 they need 30 of them.
  static uint64_t RankOf(AgendaStage stage, float ratio, uint32_t birth) {
    const uint64_t ratio_bits = ratio > 0 ? std::min(std::bit_cast<uint32_t>(ratio), 0x3fffffffu) : 0;
    return (3 - static_cast<uint64_t>(stage)) << 62 | ratio_bits << 32 | (0xffffffffu - birth);
  }
  uint32_t& TicketOf(FrontEdgeId edge) {
    if (tickets_.size() <= edge.index()) tickets_.resize(2 * edge.index() + 16, 0);
    return tickets_[edge.index()];
  }

  std::vector<Entry> heap_;  // no entry ranks above the one at half its place
  std::vector<uint32_t> tickets_;
};

}  // namespace meshfront
