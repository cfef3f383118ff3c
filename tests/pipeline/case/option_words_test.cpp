#include "pipeline/case/option_words.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "body/errors.h"
#include "body/option_names.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"

namespace umtet {
namespace {

TEST(OptionWords, EveryOptionOfTheLibraryIsAParameter) {
  for (const Option& o : option::kAll) EXPECT_NO_THROW(key_of(o)) << o.name;
  for (const Option& o : {Option{"detail"}, Option{"max_memory"}}) EXPECT_NO_THROW(key_of(o)) << o.name;  // fit_ssd()
  for (const ParamField& field : params_fields()) EXPECT_EQ(key_of({field.key.c_str()}), field.key);
  EXPECT_THROW(key_of({"mesh.hh"}), std::out_of_range);
}

TEST(OptionWords, EachFrontEndHasItsOwn) {
  EXPECT_EQ(as_flag(option::keep_all), "--keep-all");
  EXPECT_EQ(as_flag({option::h, "0.3"}), "--h 0.3");
  EXPECT_EQ(as_flag({option::merge, "false"}), "--set cloud.merge=false");
  EXPECT_EQ(as_flag(option::sizes), "--size");
  EXPECT_EQ(as_flag(option::viewpoints), "--orient-from");
  EXPECT_EQ(as_key(option::keep_all), "cloud.keep_all");
  EXPECT_EQ(as_key({option::h, "0.3"}), "mesh.h=0.3");
  EXPECT_EQ(as_keyword(option::keep_all), "keep_all");
  EXPECT_EQ(as_keyword({option::close, "none"}), "close=none");
  EXPECT_EQ(as_keyword(option::label_sizes), "size_at");
}

TEST(OptionWords, TheProgramSaysRemediesWithFlags) {
  const auto message_of = [](const auto& error) { return failure_of(std::make_exception_ptr(error)).message; };
  EXPECT_EQ(message_of(ResourceLimit("too many", {{Change::Raise, option::max_tets}})), "too many; raise --max-tets");
  EXPECT_EQ(message_of(MeshingImpossible("h is too small", {{Change::Give, {option::h, "0.3"}, "or more"}})),
            "h is too small; give --h 0.3 or more");
  EXPECT_EQ(message_of(UsageError({option::box_walls, " is for ", Setting(option::background, "a15")})),
            "--box-walls is for --background a15");
  EXPECT_EQ(message_of(UsageError("output.units: a name")), "output.units: a name");
}

}  // namespace
}  // namespace umtet
