// Which edge next? Free triangles before connections inside a working area (sec. 3), the rounder triangle first within a
// class, ties by birth: the order is a function of the input and the parameters alone.
#pragma once

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
    AgendaStage stage;
    float ratio;  // greater is better
    uint32_t birth;
    FrontEdgeId edge;
    uint32_t ticket;
  };

  void Push(AgendaStage stage, double ratio, uint32_t birth, FrontEdgeId edge) {
    heap_.push({stage, static_cast<float>(ratio), birth, edge, ++TicketOf(edge)});
  }
  // Forgets what is on the agenda for the edge: it is gone, or left the working area.
  void Cancel(FrontEdgeId edge) { ++TicketOf(edge); }
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
    bool operator()(const Entry& a, const Entry& b) const {
      if (a.stage != b.stage) return a.stage > b.stage;
      if (a.ratio != b.ratio) return a.ratio < b.ratio;
      return a.birth > b.birth;
    }
  };
  uint32_t& TicketOf(FrontEdgeId edge) {
    if (tickets_.size() <= edge.index()) tickets_.resize(2 * edge.index() + 16, 0);
    return tickets_[edge.index()];
  }

  std::priority_queue<Entry, std::vector<Entry>, Later> heap_;
  std::vector<uint32_t> tickets_;
};

}  // namespace meshfront
