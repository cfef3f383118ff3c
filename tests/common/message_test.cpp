#include "common/message.h"

#include <gtest/gtest.h>

namespace umtet {
namespace {

constexpr Option kH{"mesh.h"}, kTets{"mesh.tets"}, kKeepAll{"scan.keep_all"};

std::string as_question(const Setting& setting) {
  return std::string("?") + setting.option.name + (setting.value.empty() ? "" : ":" + setting.value);
}

TEST(Message, AFactNamesOptionsInTheWordsOfTheCaller) {
  const Message message({Setting(kH, "0.3"), " and ", kTets, ": one of them"});
  EXPECT_EQ(text_of(message), "mesh.h = 0.3 and mesh.tets: one of them");
  EXPECT_EQ(text_of(message, as_question), "?mesh.h:0.3 and ?mesh.tets: one of them");
}

TEST(Message, WordsAloneAreAMessage) {
  EXPECT_EQ(text_of(Message("no psi")), "no psi");
  EXPECT_EQ(text_of("line 3: " + Message({kH, " is no number"}) + " of lengths"), "line 3: mesh.h is no number of lengths");
}

TEST(Message, RemediesFollowTheFact) {
  const Message one("h is too small", {{Change::Give, {kH, "0.3"}, "or more"}});
  EXPECT_EQ(text_of(one), "h is too small; give mesh.h = 0.3 or more");
  const Message several("too many", {{Change::Lower, kTets}, {Change::Raise, kH}});
  EXPECT_EQ(text_of(several), "too many; lower mesh.tets, or raise mesh.h");
  const Message effects("dropped 3", {{Change::Use, kKeepAll, "keeps them"}, {Change::Use, {kH, "1"}, "does not"}});
  EXPECT_EQ(text_of(effects), "dropped 3; scan.keep_all keeps them, mesh.h = 1 does not");
  EXPECT_EQ(text_of(effects, as_question), "dropped 3; ?scan.keep_all keeps them, ?mesh.h:1 does not");
}

TEST(Message, AnErrorCarriesItsRemediesAsData) {
  try {
    throw ExplainedError("too many", {{Change::Raise, kH}});
  } catch (const ExplainedError& e) {
    EXPECT_STREQ(e.what(), "too many; raise mesh.h");
    ASSERT_EQ(e.message.remedies.size(), 1u);
    EXPECT_EQ(e.message.remedies.front().change, Change::Raise);
    EXPECT_EQ(e.message.remedies.front().setting.option, kH);
  }
}

}  // namespace
}  // namespace umtet
