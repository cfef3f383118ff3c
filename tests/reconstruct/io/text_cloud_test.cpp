// Clouds as tables of numbers in text: what their columns are, by names, by values, and as told. What is refused
// whatever the format is in tests/corpus.

#include <cmath>
#include <limits>
#include <map>

#include "tests/reconstruct/io/point_cloud_io_fixture.h"

namespace umtet {
namespace {

constexpr int kPoints = 100;  // more than 64, so that whole numbers may be too many for labels

/// What a text of the suite may have in a row: a word for each group of columns.
///   xyz n  point and normal          c f w  a colour as bytes, 0 to 1, in 16 bits
///   i I    intensity, real or whole  l      label     a  alpha of 255     k  number of the row     t  a word
const std::map<std::string, std::vector<std::string>> kNames = {{"xyz", {"x", "y", "z"}},
                                                                {"n", {"nx", "ny", "nz"}},
                                                                {"c", {"red", "green", "blue"}},
                                                                {"f", {"R", "G", "B"}},
                                                                {"w", {"r", "g", "b"}},
                                                                {"i", {"intensity"}},
                                                                {"I", {"intensity"}},
                                                                {"l", {"label"}},
                                                                {"a", {"alpha"}},
                                                                {"k", {"id"}},
                                                                {"t", {"name"}}};

Colour colour_of(int i) {
  return {static_cast<std::uint8_t>(i * 7), static_cast<std::uint8_t>(i * 13 + 5), static_cast<std::uint8_t>(i * 29)};
}
double real_of(int i) { return .37 * i - 11.25; }
int whole_of(int i) { return 37 * i - 1800; }
int label_of(int i) { return i % 5 - 1; }

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> list;
  for (std::string word; in >> word;) list.push_back(word);
  return list;
}

struct Layout {
  std::string between = " ";
  bool decimal_comma = false;
  std::string end = "\n";
};

/// The numbers of a group of columns in row i.
std::vector<std::string> columns_of(const OrientedPointCloud& cloud, int i, const std::string& group) {
  const auto three = [](const Vec3& v) {
    return std::vector<std::string>{fmt::format("{}", v.x()), fmt::format("{}", v.y()), fmt::format("{}", v.z())};
  };
  const Colour c = colour_of(i);
  if (group == "xyz") return three(cloud.points[static_cast<std::size_t>(i)]);
  if (group == "n") return three(cloud.normals[static_cast<std::size_t>(i)]);
  if (group == "f") return three(Vec3(c[0], c[1], c[2]) / 255);
  if (group == "i") return {fmt::format("{}", real_of(i))};
  if (group == "I") return {fmt::format("{}", whole_of(i))};
  if (group == "l") return {fmt::format("{}", label_of(i))};
  if (group == "a") return {"255"};
  if (group == "k") return {fmt::format("{}", i + 1)};
  if (group == "t") return {fmt::format("P{}", i)};
  const int scale = group == "w" ? 257 : 1;
  return {fmt::format("{}", scale * c[0]), fmt::format("{}", scale * c[1]), fmt::format("{}", scale * c[2])};
}

std::string joined(const std::vector<std::string>& columns, const Layout& layout) {
  return fmt::format("{}{}", fmt::join(columns, layout.between), layout.end);
}

std::string rows(const OrientedPointCloud& cloud, const std::string& groups, const Layout& layout = {}) {
  std::string text;
  for (int i = 0; i < static_cast<int>(cloud.points.size()); ++i) {
    std::vector<std::string> row;
    for (const std::string& group : words(groups)) {
      for (std::string& column : columns_of(cloud, i, group)) {
        if (layout.decimal_comma) std::replace(column.begin(), column.end(), '.', ',');
        row.push_back(std::move(column));
      }
    }
    text += joined(row, layout);
  }
  return text;
}

std::vector<std::string> names_of(const std::string& groups) {
  std::vector<std::string> names;
  for (const std::string& group : words(groups))
    names.insert(names.end(), kNames.at(group).begin(), kNames.at(group).end());
  return names;
}

class TextCloud : public PointCloudIo {
 protected:
  CloudFile scan(const std::string& name, const std::string& text, const std::string& columns = {}) {
    return read_scan(write(name, text), columns);
  }

  std::string refusal(const std::string& name, const std::string& text, const std::string& columns = {}) {
    try {
      const CloudFile file = scan(name, text, columns);
      return "accepted: " + file.report.columns;
    } catch (const CloudRefused& e) {
      return e.what();
    }
  }

  /// The file has what its groups say, and nothing else.
  void expect(const std::string& name, const std::string& text, const std::string& groups,
              const std::string& columns = {}) {
    SCOPED_TRACE(name + ": " + groups + ": " + text.substr(0, 200));
    CloudFile file;
    ASSERT_NO_THROW(file = scan(name, text, columns)) << refusal(name, text, columns);
    const OrientedPointCloud& cloud = file.cloud;
    ASSERT_EQ(cloud.points, cloud_.points);
    const std::string all = " " + groups + " ";
    const auto has = [&](const char* group) { return all.find(std::string(" ") + group + " ") != std::string::npos; };
    ASSERT_EQ(cloud.normals.size(), has("n") ? kPoints : 0u) << file.report.columns;
    ASSERT_EQ(cloud.colours.size(), has("c") || has("f") || has("w") ? kPoints : 0u) << file.report.columns;
    ASSERT_EQ(cloud.labels.size(), has("l") ? kPoints : 0u) << file.report.columns;
    ASSERT_EQ(cloud.fields.size(), has("i") || has("I") ? 1u : 0u) << file.report.columns;
    for (std::size_t k = 0; k < kPoints; ++k) {
      const int i = static_cast<int>(k);
      if (has("n")) ASSERT_LT((cloud.normals[k] - cloud_.normals[k]).norm(), 1e-15);
      if (!cloud.colours.empty()) ASSERT_EQ(cloud.colours[k], colour_of(i)) << i;
      if (has("l")) ASSERT_EQ(cloud.labels[k], label_of(i));
      if (!cloud.fields.empty()) ASSERT_EQ(cloud.fields[0].values[k], has("i") ? real_of(i) : whole_of(i));
    }
    if (!cloud.fields.empty()) EXPECT_EQ(cloud.fields[0].name, "intensity");
    EXPECT_EQ(file.report.columns.substr(0, 8), "columns ");
  }
};

const std::vector<std::string> kRows = {"xyz",       "xyz i",     "xyz I",     "xyz l",   "xyz n",   "xyz c",
                                        "xyz f",     "xyz w",     "xyz n l",   "xyz n i", "xyz i n", "xyz c n",
                                        "xyz n c",   "xyz f n",   "xyz c a",   "xyz c I", "xyz c i", "xyz i c",
                                        "xyz n c i", "xyz c n l", "xyz c a n", "k xyz n", "k xyz i", "t xyz n"};

TEST_F(TextCloud, EveryTableIsReadWithEverySeparatorAndEndOfLine) {
  for (const std::string& groups : kRows) {
    for (const char* between : {" ", "   ", "\t", ",", ", ", ";", " ; ", " \t "}) {
      expect("a.txt", rows(cloud_, groups, {between}), groups);
    }
    for (const char* between : {" ", ","}) {
      for (const char* end : {"\r\n", "\r"}) expect("a.txt", rows(cloud_, groups, {between, false, end}), groups);
    }
    for (const char* between : {" ", "\t", ";", "; "}) expect("a.csv", rows(cloud_, groups, {between, true}), groups);
    for (const char* end : {" \n", "\t\n", ";\n", "\n\n", "\n# a comment\n", "\n// another\n"}) {
      expect("a.asc", rows(cloud_, groups, {end == std::string(";\n") ? ";" : " ", false, end}), groups);
    }
  }
}

/// As headers of other programs have them; of a field the letters stay.
std::string in_capitals(std::string name) {
  if (name != "intensity")
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
  return name;
}

TEST_F(TextCloud, HeadersNameTheColumnsWithAndWithoutAMark) {
  for (const std::string& groups : kRows) {
    const std::vector<std::string> names = names_of(groups);
    std::vector<std::string> quoted, upper;
    for (const std::string& name : names) quoted.push_back('"' + name + '"'), upper.push_back(in_capitals(name));
    for (const Layout& layout : {Layout{}, Layout{","}, Layout{"\t"}}) {
      expect("a.csv", joined(names, layout) + rows(cloud_, groups, layout), groups);
    }
    const Layout german = {";", true};
    const std::string body = rows(cloud_, groups, german), plain = joined(names, german);
    for (const std::string& head :
         {plain, "# " + plain, "//" + plain, joined(quoted, german), joined(upper, german),
          "#" + joined(names, Layout{}), "A scan of 2026\n" + plain, "% of a program\n% " + joined(names, {})}) {
      expect("a.csv", head + body, groups);
    }
    EXPECT_NE(scan("a.csv", plain + body).report.columns.find("as the header says"), std::string::npos);
  }
}

TEST_F(TextCloud, ACountBeforeTheRowsIsCheckedAndBringsIntensityBeforeColours) {
  for (const char* groups : {"xyz", "xyz i", "xyz I", "xyz c", "xyz I c", "xyz i c", "xyz I n"}) {
    for (const char* name : {"a.pts", "a.txt"}) expect(name, "100\n" + rows(cloud_, groups), groups);
    EXPECT_NE(refusal("a.pts", "99\n" + rows(cloud_, groups)).find("99"), std::string::npos);
  }
  // Intensities of a byte beside colours: only the format tells them apart.
  std::string body;
  for (int i = 0; i < kPoints; ++i) {
    const Vec3& x = cloud_.points[static_cast<std::size_t>(i)];
    body += fmt::format("{} {} {} {} {}\n", x.x(), x.y(), x.z(), 2 * i, fmt::join(colour_of(i), " "));
  }
  for (const auto& [name, text] : {std::pair{"a.pts", body}, {"a.txt", "100\n" + body}}) {
    const OrientedPointCloud cloud = scan(name, text).cloud;
    ASSERT_EQ(cloud.fields.size(), 1u);
    EXPECT_EQ(cloud.fields[0].values[7], 14);
    EXPECT_EQ(cloud.colours[7], colour_of(7));
  }
  // Two scans, each behind its own count.
  const std::string all = rows(cloud_, "xyz i");
  std::size_t cut = 0;
  for (int i = 0; i < 40; ++i) cut = all.find('\n', cut) + 1;
  expect("two.pts", "40\n" + all.substr(0, cut) + "60\n" + all.substr(cut), "xyz i");
  EXPECT_NE(refusal("cut.pts", "40\n" + all.substr(0, cut) + "61\n" + all.substr(cut)).find("101"), std::string::npos);
}

TEST_F(TextCloud, NamesOfOtherProgramsAreKnown) {
  const std::string body = rows(cloud_, "xyz n", Layout{","});
  for (const char* head : {"\"Points:0\",\"Points:1\",\"Points:2\",\"Normals:0\",\"Normals:1\",\"Normals:2\"",
                           "Points_0,Points_1,Points_2,Normals_0,Normals_1,Normals_2", "X [m],Y [m],Z [m],Nx,Ny,Nz",
                           "x(mm), y(mm), z(mm), normal_x, normal_y, normal_z", "Easting,Northing,Elevation,NX,NY,NZ",
                           "x_coord,y_coord,z_coord,normalx,normaly,normalz", "//X,Y,Z,Nx,Ny,Nz"}) {
    expect("a.csv", std::string(head) + "\n" + body, "xyz n");
  }
  // As pandas writes a table: the first column has no name.
  expect("pandas.csv", ",x,y,z,nx,ny,nz\n" + rows(cloud_, "k xyz n", Layout{","}), "xyz n");
  // Another order is another order.
  std::string turned = "z;y;x\n";
  for (const Vec3& x : cloud_.points) turned += fmt::format("{};{};{}\n", x.z(), x.y(), x.x());
  expect("turned.csv", turned, "xyz");
  const CloudFile named = scan("named.txt", "x y z Heat class\n" + rows(cloud_, "xyz i l"));
  ASSERT_EQ(named.cloud.fields.size(), 2u);
  EXPECT_EQ(named.cloud.fields[0].name, "Heat");
  EXPECT_EQ(named.cloud.fields[1].values[3], label_of(3));
}

TEST_F(TextCloud, ExtensionsNameSixColumns) {
  std::string body;
  for (int i = 0; i < kPoints; ++i) {
    const Vec3 x = cloud_.points[static_cast<std::size_t>(i)],
               n = (1 + i % 7) * cloud_.normals[static_cast<std::size_t>(i)];
    body += fmt::format("{} {} {} {} {} {}\n", x.x(), x.y(), x.z(), n.x(), n.y(), n.z());
  }
  for (const char* name : {"a.xyzn", "a.npts"}) expect(name, body, "xyz n");
  EXPECT_NE(refusal("a.xyz", body).find("give columns"), std::string::npos);
  expect("a.xyzrgb", rows(cloud_, "xyz f"), "xyz f");
  expect("a.xyzrgb", rows(cloud_, "xyz c"), "xyz c");
  for (const char* name : {"a.dat", "a.tab", "a", "a.TXT"}) expect(name, rows(cloud_, "xyz n"), "xyz n");
  expect("a.scan", joined(names_of("xyz n"), Layout{}) + rows(cloud_, "xyz n"), "xyz n");
}

TEST_F(TextCloud, NormalsOfOneLengthAreNormalsWhateverItIs) {
  for (const double length : {.01, 1., 127.}) {
    std::string body;
    for (int i = 0; i < kPoints; ++i) {
      const Vec3 x = cloud_.points[static_cast<std::size_t>(i)],
                 n = length * cloud_.normals[static_cast<std::size_t>(i)];
      body += i % 20 == 3 ? fmt::format("{} {} {} 0 0 0\n", x.x(), x.y(), x.z())
                          : fmt::format("{} {} {} {:.4g} {:.4g} {:.4g}\n", x.x(), x.y(), x.z(), n.x(), n.y(), n.z());
    }
    const CloudFile file = scan("a.xyz", body);
    ASSERT_EQ(file.cloud.normals.size(), kPoints);
    EXPECT_EQ(file.report.n_normals_missing, 5u);
    EXPECT_LT((file.cloud.normals[50] - cloud_.normals[50]).norm(), 1e-3);
  }
}

TEST_F(TextCloud, WhatCannotBeGuessedAsksForColumns) {
  std::string unknown, constant;
  for (int i = 0; i < kPoints; ++i) {
    const Vec3& x = cloud_.points[static_cast<std::size_t>(i)];
    unknown += fmt::format("{} {} {} {} {} {}\n", x.x(), x.y(), x.z(), 3. * i, -1.5 * i, i % 7 + .5);
    constant += fmt::format("{} {} {} 0 0 1\n", x.x(), x.y(), x.z());
  }
  const std::string text = refusal("a.xyz", unknown);
  for (const char* part : {"a.xyz", "line 1", "columns 4 to 6", "give columns = x,y,z,nx,ny,nz"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  expect("a.xyz", unknown, "xyz", "x,y,z");
  EXPECT_EQ(scan("a.xyz", unknown, "x,y,z,u,v,w").cloud.fields.size(), 3u);
  EXPECT_EQ(scan("a.xyz", unknown, "x y z nx ny nz").cloud.normals.size(), kPoints);
  EXPECT_TRUE(scan("a.xyz", constant).cloud.normals.empty()) << "no body has one normal";
  const CloudFile two = scan("a.xyz", rows(cloud_, "xyz i i"));
  EXPECT_EQ(two.cloud.fields.size(), 2u);
  EXPECT_EQ(two.cloud.fields[1].name, "column_5");
}

TEST_F(TextCloud, ColumnsThatAreToldOverruleHeadersAndValues) {
  const std::string body = rows(cloud_, "xyz n c i"), head = "x y z nx ny nz r g b heat\n";
  expect("a.txt", head + body, "xyz", "x,y,z");
  expect("a.txt", head + body, "xyz n", "X,Y,Z,Nx,Ny,Nz,-,-,-,skip");
  expect("a.txt", body, "xyz c i", "x,y,z,,,,r,g,b,intensity");
  expect("a.txt", body, "xyz n c", "x;y;z;nx;ny;nz;red;green;blue");
  const CloudFile turned = scan("a.txt", body, "z,x,y");
  EXPECT_EQ(turned.cloud.points[5], Vec3(cloud_.points[5].y(), cloud_.points[5].z(), cloud_.points[5].x()));
  EXPECT_NE(turned.report.columns.find("as given"), std::string::npos) << turned.report.columns;
  EXPECT_EQ(scan("a.txt", rows(cloud_, "xyz l"), "x,y,z,label").cloud.labels.size(), kPoints);
  EXPECT_EQ(scan("a.txt", rows(cloud_, "xyz l"), "x,y,z,intensity").cloud.fields.size(), 1u);
  // A word stands in a column that is left out.
  expect("a.txt", rows(cloud_, "xyz t n"), "xyz n", "x,y,z,-,nx,ny,nz");
  EXPECT_NE(refusal("a.txt", rows(cloud_, "xyz n"), "x,y,z,nx,ny,nz,i").find("6 columns, but columns names 7"),
            std::string::npos);
  EXPECT_NE(refusal("a.ply", ply("ascii") + text_, "x,y,z").find("columns is about tables in text"), std::string::npos);
  for (const char* fits : {"", "x,y,z", "-,z,y,x", "x y z nx ny nz intensity", "X,Y,Z,a,b"})
    EXPECT_EQ(problem_of_columns(fits), "") << fits;
  for (const char* bad : {"x,y", "a,b,c", "x,y,z,x", "x,y,z,heat,heat", ","})
    EXPECT_NE(problem_of_columns(bad), "") << bad;
}

TEST_F(TextCloud, WhatWasNotMeasuredIsNoNumber) {
  std::string body = "x,y,z,heat\n";
  for (int i = 0; i < kPoints; ++i) {
    const Vec3& x = cloud_.points[static_cast<std::size_t>(i)];
    const char* const missing[] = {"", "NA", "nan", "null", "N/A"};
    body += fmt::format("{},{},{},{}\n", x.x(), x.y(), x.z(), i % 2 == 0 ? missing[i / 2 % 5] : "7.5");
  }
  const CloudFile file = scan("a.csv", body + ",2,3,4\n1,NaN,3,4\n");
  EXPECT_EQ(file.report.n_points_dropped, 2u);
  EXPECT_EQ(file.cloud.points, cloud_.points);
  EXPECT_TRUE(std::isnan(file.cloud.fields[0].values[4]));
  EXPECT_EQ(file.cloud.fields[0].values[5], 7.5);
}

TEST_F(TextCloud, MarksAndCommentsOfOtherProgramsAreSteppedOver) {
  const std::string body = rows(cloud_, "xyz n");
  expect("bom.csv", "\xef\xbb\xbfx,y,z,nx,ny,nz\n" + rows(cloud_, "xyz n", Layout{","}), "xyz n");
  expect("trailing.csv", "x,y,z,nx,ny,nz,\n" + rows(cloud_, "xyz n", Layout{",", false, ",\n"}), "xyz n");
  expect("behind.txt", rows(cloud_, "xyz n", Layout{" ", false, " # of the first scan\n"}), "xyz n");
  std::string quoted = "\"" + rows(cloud_, "xyz n", Layout{"\",\"", false, "\"\n\""});
  quoted.pop_back();
  expect("quoted.csv", quoted, "xyz n");
  expect("title.txt", "Leica Cyclone, 3 stations\nunits: m\n\n" + body, "xyz n");
  expect("points.xyz", "100\nmade of a ball\n" + rows(cloud_, "t xyz n"), "xyz n");
  EXPECT_NE(refusal("utf16.csv", std::string("\xff\xfe") + "x\0,\0y\0").find("UTF-8"), std::string::npos);
}

TEST_F(TextCloud, TheWholeFileDecidesAndNotItsBeginning) {
  // 3 MB: labels at first, and intensities later; colours that are black in the first megabyte.
  const OrientedPointCloud large = spiral_sphere(40000);
  std::string intensities, colours;
  for (int i = 0; i < 40000; ++i) {
    const Vec3& x = large.points[static_cast<std::size_t>(i)];
    intensities += fmt::format("{} {} {} {}\n", x.x(), x.y(), x.z(), i < 35000 ? i % 3 : i);
    colours += fmt::format("{} {} {} {}\n", x.x(), x.y(), x.z(),
                           i < 20000 ? "0 0 0" : fmt::format("{}", fmt::join(colour_of(i), " ")));
  }
  const CloudFile file = scan("a.xyz", intensities);
  EXPECT_TRUE(file.cloud.labels.empty());
  ASSERT_EQ(file.cloud.fields.size(), 1u);
  EXPECT_EQ(file.cloud.fields[0].values[39999], 39999);
  const CloudFile coloured = scan("b.xyz", colours);
  ASSERT_EQ(coloured.cloud.colours.size(), 40000u);
  EXPECT_EQ(coloured.cloud.colours[39999], colour_of(39999));
}

TEST_F(TextCloud, RefusalsNameFileLineColumnAndRemedy) {
  const std::string body = rows(cloud_, "xyz n");
  const std::vector<std::tuple<std::string, std::string, std::vector<std::string>>> files = {
      {"word.xyz", body + "1 2 3 0 zero 1\n", {"word.xyz", "line 101", "column 5", "'zero'"}},
      {"cut.csv", body + "1 2 3 0\n", {"line 101", "4 columns, but 6 before", "export it again"}},
      {"long.txt", body + "1 2 3 0 0 1 7\n", {"line 101", "7 columns, but 6 before"}},
      {"comma.csv", rows(cloud_, "xyz n", {","}) + "0.1,0.2,0.3,0,0\n", {"line 101", "5 columns"}},
      {"decimal.txt", "0.1 0.2 0.3\n0.1 0,2 0.3\n" + body, {"line 2"}},
      {"two.xyz", "1 2\n3 4\n", {"line 1", "2 columns", "x, y and z"}},
      {"one.asc", "a\n1\n2\n", {"line 3", "1 column"}},
      {"head.csv",
       "x,y,z,nx\n" + rows(cloud_, "xyz n", {","}),
       {"line 1", "4 names", "line 2", "6 columns", "give columns"}},
      {"words.txt", "this is\na letter\n", {"line 1", "no row of three or more numbers"}},
      {"first.xyz", "1 2 x\n" + body, {"line 1", "column 3", "'x'"}},
      {"binary.xyz", std::string("\x01\x02\x03\0\x04\n", 6), {"line 1", "no table of points"}},
      {"far.xyz", "1e999 0 0 0 0 1\n" + body, {"line 1", "column 1", "'1e999'", "double precision"}},
      {"novel.doc", "It was the best of times\n1 2 3\n" + body, {"no table of numbers", ".csv"}}};
  for (const auto& [name, text, parts] : files) {
    const std::string said = refusal(name, text);
    for (const std::string& part : parts) EXPECT_NE(said.find(part), std::string::npos) << name << ": " << said;
    EXPECT_LT(said.size(), 500u);
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

TEST(TextCloudScans, TheFilesThatPeopleBroughtAreRead) {
  const char* shared = std::getenv("UMTET_SHARED");
  const fs::path data = fs::path(shared != nullptr ? shared : UMTET_SOURCE_DIR "/../shared") / "data/field";
  if (!fs::exists(data / "leica.pts")) GTEST_SKIP() << "no files at " << data;
  struct Found {
    const char* file;
    std::size_t n_points;
    bool normals, colours, intensity;
  };
  for (const Found& f : {Found{"leica.pts", 2499, false, true, true},
                         {"xyzrgbn.xyz", 2500, true, true, false},
                         {"cloud.asc", 2500, true, false, false},
                         {"cloud.csv", 2499, true, false, false},
                         {"hdr.txt", 2499, false, false, false},
                         {"hdr_nohash.txt", 2499, true, false, false},
                         {"cloud.npts", 2500, true, false, false},
                         {"c.xyzrgb", 2500, false, true, false},
                         {"inten.xyz", 2500, false, false, true},
                         {"semi.txt", 2500, false, false, false},
                         {"tm_points_cloudcompare.xyz", 101, false, true, false}}) {
    const CloudFile file = read_scan(data / f.file);
    EXPECT_EQ(file.report.n_points, f.n_points) << f.file;
    EXPECT_EQ(!file.cloud.normals.empty(), f.normals) << f.file;
    EXPECT_EQ(!file.cloud.colours.empty(), f.colours) << f.file;
    EXPECT_EQ(!file.cloud.fields.empty(), f.intensity) << f.file;
    EXPECT_TRUE(file.cloud.labels.empty()) << f.file;
  }
}

}  // namespace
}  // namespace umtet
