#include "pipeline/case/json_fields.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pipeline/case/exit_code.h"

namespace umtet {

struct Inner {
  double length = 0;
  bool operator==(const Inner&) const = default;
};

struct Outer {
  enum class Kind { First, Second } kind = Kind::First;
  bool is_on = false;
  std::size_t n = 0;
  double width = 0, depth = 0;
  std::string text, note;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  std::optional<double> noise;
  std::optional<Inner> inner;
  std::vector<Inner> list;
  bool operator==(const Outer&) const = default;
};

/// @param unit  the length is also written as a ratio to it
void list_fields(JsonFields& json, Inner& inner, double unit) {
  json("length", inner.length).derived("length_over_unit", inner.length / unit);
}

void list_fields(JsonFields& json, Outer& o) {
  json.word("kind", o.kind, std::array{"first", "second"})("n", o.n);
  json.word("state", o.is_on, std::array{"off", "on"});
  json.object("size", [&](JsonFields& size) { size("width", o.width)("depth", o.depth); });
  json("text", o.text).if_any("note", o.note)("at", o.at)("noise", o.noise);
  json.if_any("inner", o.inner, 2.)("list", o.list, 2.);
}

namespace {

Outer example() {
  Outer o;
  o.kind = Outer::Kind::Second;
  o.is_on = true;
  o.n = 3;
  o.width = .1;
  o.depth = 1e-300;
  o.text = "a \"b\"";
  o.note = "note";
  o.at = {1, 2, 3};
  o.noise = .5;
  o.inner = Inner{4};
  o.list = {{1}, {6}};
  return o;
}

TEST(JsonFields, ReadWhatTheyHaveWritten) {
  for (const Outer& o : {example(), Outer()}) {
    const Json json = Json::parse(json_by_fields(o).dump());
    EXPECT_EQ(read_fields<Outer>(json), o);
  }
}

TEST(JsonFields, AreWrittenInTheOrderOfTheList) {
  EXPECT_EQ(json_by_fields(example()).dump(),
            R"({"kind":"second","n":3,"state":"on","size":{"width":0.1,"depth":1e-300},"text":"a \"b\"","note":"note",)"
            R"("at":[1.0,2.0,3.0],"noise":0.5,"inner":{"length":4.0,"length_over_unit":2.0},)"
            R"("list":[{"length":1.0,"length_over_unit":0.5},{"length":6.0,"length_over_unit":3.0}]})");
}

TEST(JsonFields, WithoutAValueAreNullOrLeftOut) {
  const Json json = json_by_fields(Outer());
  EXPECT_TRUE(json.at("noise").is_null());
  EXPECT_FALSE(json.contains("note"));
  EXPECT_FALSE(json.contains("inner"));
  EXPECT_EQ(json.at("list"), Json::array());
}

TEST(JsonFields, NullIsANumberThatIsNotFinite) {
  Outer o;
  o.width = std::numeric_limits<double>::infinity();
  const Json json = Json::parse(json_by_fields(o).dump());
  EXPECT_TRUE(json.at("size").at("width").is_null());
  EXPECT_TRUE(std::isnan(read_fields<Outer>(json).width));
}

TEST(JsonFields, ThatAreMissingOrOfAnotherTypeAreRefused) {
  const Json whole = json_by_fields(example());
  for (const char* name : {"kind", "n", "state", "size", "text", "at", "noise", "list"}) {
    Json json = whole;
    json.erase(name);
    EXPECT_THROW(read_fields<Outer>(json), Json::exception) << name;
    json[name] = Json::object();
    EXPECT_THROW(read_fields<Outer>(json), Json::exception) << name;
  }
}

TEST(JsonFields, WithAnUnknownWordAreRefused) {
  Json json = json_by_fields(example());
  json["kind"] = "third";
  EXPECT_THROW(read_fields<Outer>(json), ArtefactDamaged);
}

}  // namespace
}  // namespace umtet
