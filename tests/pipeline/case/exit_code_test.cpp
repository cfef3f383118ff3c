#include "pipeline/case/exit_code.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace umtet {
namespace {

template <class E>
Failure failure(const E& e) {
  return failure_of(std::make_exception_ptr(e));
}

TEST(ExitCode, ABrokenContractBetweenOurPartsIsOurBugNotTheUsers) {
  const Failure f = failure(std::invalid_argument("points[3] is not finite"));
  EXPECT_EQ(f.code, ExitCode::Bug);
  EXPECT_NE(f.message.find("points[3]"), std::string::npos);
  EXPECT_NE(f.message.find("case folder"), std::string::npos) << f.message;
  EXPECT_EQ(failure(std::runtime_error("?")).code, ExitCode::Bug);
  EXPECT_EQ(failure(std::out_of_range("?")).code, ExitCode::Bug);
}

TEST(ExitCode, WhatIsTooLargeIsAResourceLimit) {
  EXPECT_EQ(failure(std::length_error("3e9 nodes")).code, ExitCode::ResourceLimit);
  EXPECT_EQ(failure(std::length_error("3e9 nodes")).message, "3e9 nodes");
  EXPECT_EQ(failure(std::bad_alloc()).code, ExitCode::ResourceLimit);
  EXPECT_EQ(failure(ResourceLimit("?")).code, ExitCode::ResourceLimit);
}

TEST(ExitCode, AMeshThatIsThereButNotCertifiedIsNotOneThatIsNotThere) {
  EXPECT_EQ(failure(MeshingImpossible("?")).code, ExitCode::MeshingImpossible);
  EXPECT_EQ(failure(CertificateFailed("?")).code, ExitCode::GateFailed);
}

TEST(ExitCode, WhatIsTooThinHasItsPlacesAsEvidence) {
  ThinPlace place;
  place.thickness = .01;
  const Failure known = failure(TooThin("?", {{place}, .1, .02})), unknown = failure(TooThin("?", {{place}, .1, {}}));
  EXPECT_EQ(known.code, ExitCode::MeshingImpossible);
  EXPECT_EQ(known.evidence.at("too_thin").size(), 1U);
  EXPECT_EQ(known.evidence.at("h_enough"), .02);
  EXPECT_TRUE(unknown.evidence.at("h_enough").is_null());
}

TEST(ExitCode, UsageAndFilesKeepTheirs) {
  EXPECT_EQ(failure(UsageError("?")).code, ExitCode::Usage);
  EXPECT_EQ(failure(std::system_error(ENOSPC, std::generic_category())).code, ExitCode::FileTrouble);
}

}  // namespace
}  // namespace umtet
