#include "scene_text.hpp"
#include "tests/support/files.hpp"
#include "tests/support/processor_time.hpp"

#include "discretization/reading/import.hpp"
#include "discretization/text/csv_file.hpp"

namespace mixbeam {
namespace {

/// Tables beside a scene.
class SceneImport : public ::testing::Test {
 protected:
  void write(const std::string& file, const std::string& text) const { write_text(folder_ / file, text); }

  Scene read(const std::string& more = "", const std::string& points = "", const std::string& members = "") const {
    const std::string import = "Import: {Points File: points.csv, Members File: members.csv, " + more + "}, ";
    return described_by(parsed(scene_text(points, members, import), (folder_ / "").string()));
  }

  void expect_refused(const std::vector<std::string>& parts) const {
    expect_in(message_of([&] { read(); }), parts);
  }

  auto refused_with(const std::string& file) const {
    return [=](const std::string& table, const std::vector<std::string>& parts) {
      write(file, table);
      expect_refused(parts);
    };
  }

  const TemporaryFolder folder_;
};

const std::string kPoints = "A,0,0,0\nB,1,0,0\nC,1,1e0,-2.5\n";
const std::string kMembers = "m,A,B,flat\nn,B,C,flat,3,7\n";

TEST_F(SceneImport, ReadsTables) {
  write("points.csv", kPoints);
  write("members.csv", kMembers);
  const Scene scene = read();
  expect_at(scene, "C", {1, 1, -2.5}, 0.0);
  ASSERT_EQ(scene.members.size(), 2U);
  const Member &m = scene.members[0], &n = scene.members[1];
  EXPECT_EQ(std::tie(m.order, m.elements), std::tuple(2, 1));
  EXPECT_EQ(std::tie(n.start_point, n.order, n.elements), std::tuple("B", 3, 7));
  const Scene joined = read("", "D: [0, 5, 0], ", member("o", "D", "C"));
  EXPECT_EQ(joined.members.size(), 3U);
  EXPECT_EQ(member_in(joined, "o")->end_point, "C");
}

TEST_F(SceneImport, CellsMayBeFormulas) {
  write("points.csv", "A,0,0,0\nB,=x('A')+2*h,0,0\nC,=x('B'),1,-2.5\n");
  write("members.csv", "m,A,B,flat\nn,B,C,flat,3,=2*h\n");
  write("loads.csv", "name,point,force\nl,C,\"{0, =-h, =x('C')}\"\n");
  const std::string import =
      "Variables: {h: 2, w: \"=y('C')\"}, Import: {Points File: points.csv, Members File: members.csv, Point Loads "
      "File: "
      "loads.csv}, ";
  XmlParameters file = parsed(scene_text("", "", import), (folder_ / "").string());
  import_entries(file.list->sublist("Scene"), file.source);
  const Scene scene = described_by(file);
  expect_at(scene, "C", {4, 1, -2.5}, 0.0);
  EXPECT_EQ(scene.members[1].elements, 4);
  EXPECT_EQ(scene.point_loads[0].force, (Vector3{0, -2, 4}));
  EXPECT_EQ(file.list->sublist("Scene").sublist("Variables").get<double>("w"), 1.0);
  write("points.csv", "A,0,0,0\nB,=x('C'),0,0\nC,=x('B'),1,-2.5\n");
  expect_refused({"points.csv:3:", "needs itself: x(C) -> x(B) -> x(C)"});
  write("points.csv", "A,0,0,0\nB,=hh,0,0\nC,2,1,-2.5\n");
  expect_refused({"points.csv:2:", "x: value", "=hh", "no variables"});
}

TEST_F(SceneImport, TheOnlySectionIsMeantWhereNoneIsNamed) {
  write("points.csv", kPoints);
  write("members.csv", "m,A,B\n");
  EXPECT_EQ(read().members[0].section, "flat");
  write("members.csv", "m,A,B\nn,B,A,flat\n");
  expect_refused({"members.csv:2:1: ", "member \"n\" of section \"flat\" is the same line as \"m\""});
}

TEST_F(SceneImport, PointsThatOnlyImportedMembersTouchAreUsed) {
  write("points.csv", kPoints);
  write("members.csv", kMembers + "o,C,D,flat\n");
  EXPECT_EQ(read("", "D: [0, 5, 0]").members.size(), 3U);
  EXPECT_THROW(read("", "D: [0, 5, 0], E: [0, 6, 0]"), InputError);
}

TEST_F(SceneImport, UnderstandsWhatProgramsWrite) {
  write("points.csv",
        "\xEF\xBB\xBF# exported\r\n\r\n  \"Name\" ;z; Y;x\r\n\"A\";0;0;0\r\n\"the \"\"B\"\"; here\" ; 3 ;2;+1\r\n");
  write("members.csv", "name\tstart\tend\telements\tsection\nm\tA\t\"the \"\"B\"\"; here\"\t4\t\nn\tA\tA\t\t\n");
  EXPECT_THROW(read("Section: flat"), InputError);  // n has no length
  write("members.csv", "name\tstart\tend\telements\tsection\nm\tA\t\"the \"\"B\"\"; here\"\t4\t");
  const Scene scene = read("Section: flat, Order: 5");
  expect_at(scene, "the \"B\"; here", {1, 2, 3}, 0.0);
  EXPECT_EQ(scene.members[0].section, "flat");
  EXPECT_EQ(scene.members[0].order, 5);
  EXPECT_EQ(scene.members[0].elements, 4);
}

TEST_F(SceneImport, ErrorsNameLineAndColumn) {
  write("members.csv", kMembers);
  const auto refused = refused_with("points.csv");
  refused("A,0,0,0\nB,1,O,0\n", {"points.csv:2:5: ", "y: value \"O\" is not a number"});
  refused("A,0,0,0\n# no\n\nB,1,0\n", {"points.csv:4:1: ", "missing \"z\""});
  refused("A,0,0,0,9\n", {"points.csv:1:9: ", "one cell too many"});
  refused("A,0,0,nan\n", {"points.csv:1:7: ", "z: value nan"});
  refused("A,0,0,1e101\n", {"points.csv:1:7: ", "<= 1e+100"});
  refused("A,0,0,0\nA,1,0,0\n", {"points.csv:2:1: ", "\"A\" is the name of another point"});
  refused("A,0,0,0\n..,1,0,0\n", {"points.csv:2:1: ", "\"..\"", "result file"});
  refused("\"A,0,0,0\n", {"points.csv:1:1: ", "not closed"});
  refused("\"A\"x,0,0,0\n", {"points.csv:1:4: ", "after a closing quote"});
  refused("name,x,y,zz\nA,0,0,0\n", {"points.csv:1:10: ", "\"zz\" is not a column", "did you mean \"z\"?"});
  refused("name,x,y\nA,0,0\n", {"points.csv:1:1: ", "no column \"z\""});
  refused("name,x,x,z\n", {"points.csv:1:8: ", "second time"});
  refused("\xC3\xA4,0,b,0\n", {"points.csv:1:5: ", "\"b\""});  // columns count characters
  refused("A,\xFF,0,0\n", {"points.csv:1: ", "UTF-8"});
  refused(std::string("A,0,0,0\0", 8), {"UTF-8"});
}

TEST_F(SceneImport, ErrorsInMembersNameLineAndColumn) {
  write("points.csv", kPoints);
  const auto refused = refused_with("members.csv");
  refused("m,A,B,flat\nn,B,Q,flat\n", {"members.csv:2:5: ", "member \"n\"", "\"Q\" is not a point"});
  refused("m,A,B,flat\nn,B,C,flet\n", {"members.csv:2:7: ", "did you mean \"flat\"?"});
  refused("m,A,B,flat,9\n", {"members.csv:1:12: ", "order: value 9", "1 <= value <= 8"});
  refused("m,A,B,flat,2,0\n", {"members.csv:1:14: ", "elements: value 0"});
  refused("m,A,B,flat\nn/1,B,C,flat\n", {"members.csv:2:1: ", "\"n/1\"", "without \"/\""});
  refused("m,A,B,flat\nn,B,B,flat\n", {"members.csv:2:1: ", "no length"});
  refused("m,A,B,flat\nm,B,C,flat\n", {"members.csv:2:1: ", "\"m\" is the name of another member"});
  refused("m,A,B,flat\nn,B,C,flat\no,B,A,flat\n",
          {"members.csv:3:1: ", "member \"o\" of section \"flat\" is the same line as \"m\", from \"A\" to \"B\""});
  refused("m,A,B,flat,1,9000000\nn,B,C,flat,1,9000000\n", {"members.csv:2:14: ", "18000000 elements"});
  refused("\n# nothing\n", {"members.csv:1:1", "the table is empty", "\"section\""});
}

TEST_F(SceneImport, NamesAFileThatIsNotThere) {
  write("points.csv", kPoints);
  expect_refused({"scene.yaml:", "\"Scene / Import / Members File\"", "there is no file"});
  std::filesystem::create_directories(folder_ / "members.csv");
  expect_refused({"\"Scene / Import / Members File\"", "there is no file"});
}

TEST_F(SceneImport, ManyMembersTakeLinearTime) {
  constexpr int kMembersOfChain = 30'000;  // quadratic time would take minutes
  std::string points, members;
  for (int i = 0; i <= kMembersOfChain; ++i) points += "p" + std::to_string(i) + "," + std::to_string(i) + ",0,0\n";
  for (int i = 0; i < kMembersOfChain; ++i)
    members += "m" + std::to_string(i) + ",p" + std::to_string(i) + ",p" + std::to_string(i + 1) + ",flat\n";
  write("points.csv", "A,0,1,0\n" + points);
  write("members.csv", "first,A,p0,flat\n" + members);
  EXPECT_LT(processor_seconds([&] { EXPECT_EQ(read().members.size(), kMembersOfChain + 1U); }), 20.0);
}

/// Columns count characters, and a line of many cells is read in time that grows with them.
TEST(CsvFile, ColumnsOfALongLine) {
  constexpr int kCells = 200'000;
  std::string line = "\xC3\xA4";  // one character, two bytes
  for (int i = 1; i < kCells; ++i) line += ",1";
  const auto read = [&] {
    const CsvFile file("t.csv", line);
    file.for_each([&](const CsvRecord& record) {
      ASSERT_EQ(record.columns.size(), static_cast<std::size_t>(kCells));
      EXPECT_EQ(record.columns[1], 3);
      EXPECT_EQ(record.columns.back(), 2 * kCells - 1);
    });
  };
  EXPECT_LT(processor_seconds(read), 5.0);
}

TEST(CsvFile, RecordsKeepTheirPlaces) {
  const CsvFile file("t.csv", "a, b ,\"c,\"\"d\"\n\n  # no\rlast");
  std::vector<CsvRecord> records;
  file.for_each([&](const CsvRecord& record) { records.push_back(record); });
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].cells, (std::vector<std::string>{"a", "b", "c,\"d"}));
  EXPECT_EQ(records[0].columns, (std::vector<int>{1, 4, 7}));
  EXPECT_EQ(records[1].line, 4);
  EXPECT_EQ(records[1].cells, (std::vector<std::string>{"last"}));
  EXPECT_EQ(file.record_at(4).cells[0], "last");
  EXPECT_TRUE(file.record_at(2).cells.empty());
}

/// Entries of other lists, as read_scene_file() adds them.
class EntryImport : public SceneImport {
 protected:
  Scene scene_with(const std::string& import, const std::string& more = "") const {
    const std::string points = "A: [0, 0, 0], B: [1, 0, 0], ";
    XmlParameters xml =
        parsed(scene_text(points, member("m", "A", "B"), "Import: {" + import + "}, " + more), (folder_ / "").string());
    import_entries(xml.list->sublist("Scene"), xml.source);
    return described_by(xml);
  }
};

TEST_F(EntryImport, ColumnsAreTheParametersOfEntries) {
  write("loads.csv", "name,point,force,case\np 1,B,\"{0, 0, -10}\",\np 2,*,\"{1, 2, 3}\",snow\n");
  write("supports.csv", "name;point;Fixed Rotation;rotation stiffness\nroller;B;{x};{0, 0, 5}\n");
  write("sections.csv", "name,shape,diameter,e,nu,strength\nrod,circle,0.1,2e11,0.3,1e8\n");
  write("lines.csv", "name,member,force\nweight,m,\"{0, 0, -1}\"\n");
  write("joints.csv", "name,point,members,kind\n");
  const Scene scene = scene_with(
      "Point Loads File: loads.csv, Supports File: supports.csv, Sections File: sections.csv, Joints File: joints.csv, "
      "Distributed Loads File: lines.csv, ",
      "Load Cases: [snow]");
  ASSERT_EQ(scene.point_loads.size(), 3U);
  EXPECT_EQ(scene.point_loads[0].force, (Vector3{0, 0, -10}));
  EXPECT_EQ(scene.point_loads[2].load_case, "snow");
  ASSERT_EQ(scene.supports.size(), 2U);
  EXPECT_EQ(scene.supports[1].rotation_stiffness, (Vector3{0, 0, 5}));
  ASSERT_EQ(scene.sections.size(), 2U);
  EXPECT_EQ(scene.sections[1].shape->strength, 1e8);
  EXPECT_EQ(scene.distributed_loads.size(), 1U);
  EXPECT_TRUE(scene.joints.empty());
}

TEST_F(EntryImport, ErrorsNameTheCell) {
  const auto refused = [&](const std::string& text, const std::vector<std::string>& parts) {
    write("loads.csv", text);
    expect_in(message_of([&] { scene_with("Point Loads File: loads.csv"); }), parts);
  };
  refused("name,point,forse\np,B,1\n", {"loads.csv:1:", "\"forse\"", "did you mean \"force\"?"});
  refused("name,point,force\np,B,\"{0, 0}\"\n", {"loads.csv:2:5", "force"});
  refused("name,point,force\np,Bb,\"{0, 0, 1}\"\n", {"loads.csv:2:3", "Scene / Point Loads / p / Point", "\"Bb\""});
  refused("name,point,force\np,B,\"{0, 0, 1}\"\np,B,\"{0, 0, 1}\"\n", {"loads.csv:3:1", "already"});
  expect_in(message_of([&] { scene_with("Joints File: none.csv"); }), {"there is no file", "none.csv"});
}

TEST_F(EntryImport, OffsetsOfPointsComeByNameOrPlace) {
  write("offsets.csv", "name,x,y,z,dx,dy,dz\nA,,,,0.1,0,0\n,1,1e-9,0,0,0.2,0\n");
  const std::string file = "Imperfection: {Points File: offsets.csv}, ";
  const Scene scene = scene_with("", file);
  expect_at(scene, "A", {0.1, 0, 0}, 0.0);
  expect_at(scene, "B", {1, 0.2, 0}, 0.0);
  write("offsets.csv", "x,y,z,dx,dy,dz\n1,0.1,0,0,0.2,0\n");
  expect_in(message_of([&] { scene_with("", file); }), {"offsets.csv:2:1", "no point of the scene lies at"});
  write("offsets.csv", "name,dx,dy,dz\nAB,0,0.2,0\n");
  expect_in(message_of([&] { scene_with("", file); }), {"offsets.csv:2:1", "\"AB\" is not a point"});
}

}  // namespace
}  // namespace mixbeam
