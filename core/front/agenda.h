// Which edge next? Free triangles before connections inside a working area (sec. 3), the rounder triangle first within a
// class, ties by birth: the order is a function of the input and the parameters alone.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <queue>
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
    heap_.push({RankOf(stage, static_cast<float>(ratio), birth), edge, ++TicketOf(edge)});
  }
  // Forgets what is on the agenda for the edge: it is gone, or left the working area.
  void Cancel(FrontEdgeId edge) { ++TicketOf(edge); }
  // Nothing is left, not even what no longer counts.
  bool empty() const { return heap_.empty(); }
  // The next entry that still counts; false when there is none.
  bool Pop(Entry& entry) {
    while (!heap_.empty()) {
      entry = heap_.top();
      heap_.pop();
      if (entry.ticket == TicketOf(entry.edge)) return true;
    }
    return false;
  }

 private:
  struct Later {
    bool operator()(const Entry& a, const Entry& b) const { return a.rank < b.rank; }
  };
  // Floats that are not negative are ordered as their bits are; below 2 they need 30 of them.
  static uint64_t RankOf(AgendaStage stage, float ratio, uint32_t birth) {
    const uint64_t ratio_bits = ratio > 0 ? std::min(std::bit_cast<uint32_t>(ratio), 0x3fffffffu) : 0;
    return (3 - static_cast<uint64_t>(stage)) << 62 | ratio_bits << 32 | (0xffffffffu - birth);
  }
  uint32_t& TicketOf(FrontEdgeId edge) {
    if (tickets_.size() <= edge.index()) tickets_.resize(2 * edge.index() + 16, 0);
    return tickets_[edge.index()];
  }

  std::priority_queue<Entry, std::vector<Entry>, Later> heap_;
  std::vector<uint32_t> tickets_;
};

}  // namespace meshfront
