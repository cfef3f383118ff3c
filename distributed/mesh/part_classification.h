#pragma once

#include "distributed/exchange/neighbourhood.h"
#include "distributed/partition/lattice_part.h"
#include "mesh/classification/classification_part.h"

namespace umtet {

/// Exchange of vertex states between ranks, each of which classifies the vertices of its own blocks.
class PartClassification final : public ClassificationPart {
 public:
  PartClassification(const LatticePart& part, Neighbourhood& ranks) : part_(part), ranks_(ranks) {}
  bool knows(std::int64_t v) const override { return part_.known().test_any(v); }
  bool owns(std::int64_t v) const override { return part_.own().test(v); }
  bool shares(std::int64_t v) const override { return knows(v) && !part_.knowers(v).empty(); }
  std::vector<VertexState> exchange(const std::vector<VertexState>& changed) override;
  std::size_t sum(std::size_t n) override { return ranks_.sum(n); }

 private:
  const LatticePart& part_;
  Neighbourhood& ranks_;
};

}  // namespace umtet
