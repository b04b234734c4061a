#include "core/front/agenda.h"

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace meshfront {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<uint32_t> Drain(Agenda& agenda) {
  std::vector<uint32_t> order;
  for (Agenda::Entry entry; agenda.Pop(entry);) order.push_back(entry.edge.index());
  return order;
}

TEST(Agenda, TakesFreeTrianglesBeforeSearchesBeforeConnections) {
  Agenda agenda;
  agenda.Push(AgendaStage::kConnect, 0.99, 0, FrontEdgeId(1));
  agenda.Push(AgendaStage::kSearch, 0.99, 1, FrontEdgeId(2));
  agenda.Push(AgendaStage::kFree, 0.01, 2, FrontEdgeId(3));
  EXPECT_THAT(Drain(agenda), ElementsAre(3, 2, 1));
}

TEST(Agenda, TakesTheRounderTriangleFirst) {
  Agenda agenda;
  agenda.Push(AgendaStage::kFree, 0.5, 0, FrontEdgeId(1));
  agenda.Push(AgendaStage::kFree, 0.9, 1, FrontEdgeId(2));
  agenda.Push(AgendaStage::kFree, 0.7, 2, FrontEdgeId(3));
  EXPECT_THAT(Drain(agenda), ElementsAre(2, 3, 1));
}

TEST(Agenda, TakesTheOlderEdgeOfTwoEquals) {
  Agenda agenda;
  agenda.Push(AgendaStage::kFree, 0.5, 7, FrontEdgeId(1));
  agenda.Push(AgendaStage::kFree, 0.5, 3, FrontEdgeId(2));
  agenda.Push(AgendaStage::kFree, 0.5, 5, FrontEdgeId(3));
  EXPECT_THAT(Drain(agenda), ElementsAre(2, 3, 1));
}

TEST(Agenda, SkipsWhatWasSaidBeforeOfAnEdge) {
  Agenda agenda;
  agenda.Push(AgendaStage::kFree, 0.9, 0, FrontEdgeId(1));
  agenda.Push(AgendaStage::kConnect, 0.1, 0, FrontEdgeId(1));
  agenda.Push(AgendaStage::kSearch, 0, 1, FrontEdgeId(2));
  EXPECT_THAT(Drain(agenda), ElementsAre(2, 1));
}

TEST(Agenda, ForgetsACancelledEdge) {
  Agenda agenda;
  agenda.Push(AgendaStage::kFree, 0.9, 0, FrontEdgeId(1));
  agenda.Push(AgendaStage::kFree, 0.8, 1, FrontEdgeId(900));
  agenda.Cancel(FrontEdgeId(1));
  agenda.Cancel(FrontEdgeId(5000));  // never heard of
  EXPECT_THAT(Drain(agenda), ElementsAre(900));
  agenda.Push(AgendaStage::kFree, 0.2, 9, FrontEdgeId(1));  // the slot's next life
  EXPECT_THAT(Drain(agenda), ElementsAre(1));
  EXPECT_THAT(Drain(agenda), IsEmpty());
}

// The order is a function of what is on the agenda, not of the order in which it came.
TEST(Agenda, DoesNotDependOnTheOrderOfPushes) {
  std::mt19937_64 random(1);
  struct Push {
    AgendaStage stage;
    double ratio;
    uint32_t birth;
  };
  std::vector<Push> pushes;
  for (uint32_t i = 0; i < 300; ++i)
    pushes.push_back({AgendaStage(random() % 3), static_cast<double>(random() % 5) / 4, i});
  std::vector<uint32_t> first;
  for (int round = 0; round < 5; ++round) {
    Agenda agenda;
    for (const Push& p : pushes) agenda.Push(p.stage, p.ratio, p.birth, FrontEdgeId(p.birth));
    const std::vector<uint32_t> order = Drain(agenda);
    if (round == 0) first = order;
    EXPECT_EQ(order, first);
    std::shuffle(pushes.begin(), pushes.end(), random);
  }
}

}  // namespace
}  // namespace meshfront
