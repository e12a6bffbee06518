/// Scenes as the schemas judge them: all of the repository are valid, and mutated ones are refused where the reader
/// does; each is the same in XML and YAML.
#include "apps/common/run/scene_file.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/parameters/value.hpp"
#include "process.hpp"
#include "tests/support/ranks.hpp"

#include <libxml/parser.h>
#include <libxml/relaxng.h>

#include <algorithm>
#include <memory>
#include <random>
#include <regex>

namespace mixbeam::judgement_test {
namespace {

using XmlDocument = std::unique_ptr<xmlDoc, void (*)(xmlDocPtr)>;

/// What judges scenes: the reader, and the schema of each format.
class Judgement : public ::testing::Test {
 protected:
  Judgement() {
    const std::string text = output_of(kMixbeam + "schema");
    xmlRelaxNGParserCtxtPtr parser = xmlRelaxNGNewMemParserCtxt(text.data(), static_cast<int>(text.size()));
    schema_.reset(xmlRelaxNGParse(parser));
    xmlRelaxNGFreeParserCtxt(parser);
    definition_.name = "scene";
    definition_.study = ListSpec("").without_checks();
    definition_.chooses_meshes = definition_.answers_quantities = true;
    app_communicator_ = test::all_ranks();
  }

  bool accepts_xml(const std::string& text) const {
    const XmlDocument document(
        xmlReadMemory(text.data(), static_cast<int>(text.size()), "", nullptr, XML_PARSE_NOERROR), xmlFreeDoc);
    if (!document) return false;
    xmlRelaxNGValidCtxtPtr context = xmlRelaxNGNewValidCtxt(schema_.get());
    xmlRelaxNGSetValidErrors(context, nullptr, nullptr, nullptr);
    xmlRelaxNGSetValidStructuredErrors(
        context, [](void*, xmlErrorPtr) {}, nullptr);
    const bool valid = xmlRelaxNGValidateDoc(context, document.get()) == 0;
    xmlRelaxNGFreeValidCtxt(context);
    return valid;
  }

  /// What the JSON Schema has against each text; empty where it is valid.
  std::vector<std::string> against_yaml(const std::vector<std::string>& texts) const {
    const TemporaryFolder folder;
    write_text(folder / "schema.json", output_of(kMixbeam + "schema --json"));
    std::string command =
        "/usr/bin/python3 " MIXBEAM_SOURCE_DIR "/tests/apps/schema_check.py " + (folder / "schema.json").string();
    for (std::size_t i = 0; i < texts.size(); ++i) {
      const fs::path file = folder / (std::to_string(i) + ".yaml");
      write_text(file, texts[i]);
      command += " " + file.string();
    }
    std::vector<std::string> verdicts;
    std::istringstream lines(output_of(command));
    for (std::string line; std::getline(lines, line);) verdicts.push_back(line);
    EXPECT_EQ(verdicts.size(), texts.size());
    verdicts.resize(texts.size());
    return verdicts;
  }

  /// Message of the refusal; empty where the scene is read.
  std::string refusal_of(const std::string& text, const std::string& file) const {
    Application app;
    app.communicator = app_communicator_;
    try {
      const ListSpec root = root_spec(definition_);
      read_scene_file(app, parse_parameters(text, file, root), definition_, root);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::string yaml_of(const std::string& xml) const {
    return yaml_text(parse_xml(xml, "scene.xml"), root_spec(definition_), "scene.yaml");
  }

  ApplicationDefinition definition_;
  Communicator app_communicator_;
  std::unique_ptr<xmlRelaxNG, void (*)(xmlRelaxNGPtr)> schema_{nullptr, xmlRelaxNGFree};
};

std::vector<std::string> scenes_in(const std::vector<std::string>& folders) {
  std::vector<std::string> texts;
  for (const std::string& folder : folders)
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(MIXBEAM_SOURCE_DIR) / folder))
      if (entry.path().extension() == ".xml") texts.push_back(text_of(entry.path()));
  std::sort(texts.begin(), texts.end());
  return texts;
}

/// Names and values of a list, with all their digits. A whole number for a real is the same in YAML.
std::string values_of(const Teuchos::ParameterList& list) {
  std::string text;
  for (auto entry = list.begin(); entry != list.end(); ++entry) {
    const std::string& name = list.name(entry);
    text += name + " = ";
    text += list.isSublist(name) ? "{" + values_of(list.sublist(name)) + "}\n"
                                 : to_text(value_of(list.entry(entry))) + "\n";
  }
  return text;
}

std::string values_of_xml(const std::string& text) {
  const XmlParameters xml = parse_xml(text, "scene.xml");
  return xml.list->name() + "\n" + values_of(*xml.list);
}

TEST_F(Judgement, EverySceneSurvivesTheWayToYamlAndBack) {
  const std::vector<std::string> scenes = scenes_in({"apps", "tests"});
  EXPECT_GT(scenes.size(), 50u);
  for (const std::string& scene : scenes) {
    const XmlParameters back = parse_yaml(yaml_of(scene), "scene.yaml", root_spec(definition_));
    EXPECT_EQ(values_of_xml(xml_text(*back.list)), values_of_xml(scene)) << scene;
  }
  EXPECT_NE(values_of_xml(changed(scenes[0], "type=\"double\" value=\"", "type=\"double\" value=\"1")),
            values_of_xml(scenes[0]));
}

TEST_F(Judgement, AllScenesOfTheRepositoryAreValid) {
  const std::vector<std::string> scenes = scenes_in({"apps", "tests"});
  EXPECT_GT(scenes.size(), 50u);
  std::vector<std::string> in_yaml;
  for (const std::string& scene : scenes) {
    EXPECT_TRUE(accepts_xml(scene)) << scene;
    in_yaml.push_back(yaml_of(scene));
  }
  EXPECT_FALSE(accepts_xml(changed(scenes[0], "\"Members\"", "\"Membres\"")));
  in_yaml.push_back(changed(in_yaml[0], "Members:", "Membres:"));
  const std::vector<std::string> verdicts = against_yaml(in_yaml);
  for (std::size_t i = 0; i + 1 < verdicts.size(); ++i) EXPECT_EQ(verdicts[i], "") << in_yaml[i];
  EXPECT_NE(verdicts.back(), "");
}

/// Without those whose tables lie beside them.
std::vector<std::string> scenes_without_tables() {
  std::vector<std::string> texts = scenes_in({"apps/gallery"});
  texts.erase(std::remove_if(texts.begin(), texts.end(),
                             [](const std::string& text) { return text.find("File\"") < text.size(); }),
              texts.end());
  return texts;
}

/// Refusals of the reader that a schema cannot foresee: a part of the message, and why.
using Unforeseen = std::vector<std::pair<std::string, std::string>>;

const Unforeseen kUnforeseen = {
    {" of the scene; allowed", "names that something else must bear"},
    {"no member starts or ends there", "likewise"},
    {"unused: no member", "likewise"},
    {"/ Quantity\": value", "likewise, of the list Quantities"},
    {"missing section", "may be absent only where there is one section"},
    {"missing point", "an empty name"},
    {"Source\": value \"\"", "an empty text"},
    {"has no direction", "length of a vector"},
    {"the wall thickness is", "dimensions of a shape depend on each other"},
    {"but the curve ends at", "the end of a curve is computed"},
    {"loads nothing", "no value differs from its default"},
    {"neither of \"Absolute Tolerance\" and \"Relative Tolerance\"", "checked behind the declarations"},
    {"no difference is small relative to the value 0", "a number depends on another one"},
    {"where the load path of the scene ends", "likewise"},
    {"along a whole member; allowed without", "parameters depend on each other"},
    {"given beside stiffness values", "likewise"},
    {"or \"Matrix\" instead of all stiffness values", "likewise"},
    {"Material / nu\": missing", "likewise"},
    {"so no utilisation", "of what a section is made"},
    {"is no formula", "what a formula is"},
    {"allowed: a member with one end at", "how members are joined"},
    {"can move without strain", "mechanics"},
};
const Unforeseen kUnforeseenInXml = {
    {"missing", "elements of one name cannot be counted: none needed"},
    {"given twice", "likewise"},
    {"has no meaning for", "a list of one name cannot depend on a word in it"},
};
const Unforeseen kUnforeseenInYaml = {
    {"given twice", "the parsers of editors notice that, a schema sees one"},
    {"/ Component\": value \"1.0\"", "the number 1 of JSON, where the word 1 is allowed"},
    {"of type double; allowed: int", "1.0 is an integer of JSON"},
};

/// Mutated scenes, and how many of them both refuse.
class Comparison {
 public:
  explicit Comparison(Unforeseen more) : more_(std::move(more)) {}

  void add(const std::string& text, const std::string& reader, const std::string& schema) {
    if (reader.empty() != schema.empty()) {
      EXPECT_TRUE(schema.empty() && is_unforeseen(reader)) << "reader: " << reader << "\nschema: " << schema << "\n"
                                                           << text;
      ++unforeseen;
    } else if (!reader.empty()) {
      ++refused;
    } else {
      ++read;
    }
  }

  int read = 0, refused = 0, unforeseen = 0;

 private:
  bool is_unforeseen(const std::string& message) const {
    for (const Unforeseen* reasons : {&kUnforeseen, &more_})
      for (const auto& [part, reason] : *reasons)
        if (message.find(part) != std::string::npos) return true;
    return false;
  }

  Unforeseen more_;
};

constexpr int kMutations = 200;
/// By both, or the mutations were all harmless, or all beyond a schema.
constexpr int kLeastRead = 10, kLeastRefused = 80;

/// Replaces, removes or doubles one random match of `pattern` ($1: name, $2: value).
class Mutator {
 public:
  std::string mutated(const std::string& text, const std::regex& pattern, const std::vector<std::string>& values) {
    std::vector<std::smatch> places(std::sregex_iterator(text.begin(), text.end(), pattern), std::sregex_iterator());
    const std::smatch& place = places[below(places.size())];
    const auto begin = [&](int group) { return static_cast<std::size_t>(place.position(group)); };
    const std::string whole = place.str();
    switch (below(6)) {
      case 0:
        return std::string(text).erase(begin(0), whole.size());
      case 1:
        return std::string(text).insert(begin(0), whole);
      case 2:
        return std::string(text).insert(begin(1) + place.str(1).size(), "s");
      default:
        return std::string(text).replace(begin(2), place.str(2).size(), values[below(values.size())]);
    }
  }

  std::size_t below(std::size_t bound) { return random_() % bound; }

 private:
  std::mt19937 random_{20261123};
};

TEST_F(Judgement, MutatedXmlIsJudgedAsByTheReader) {
  const std::vector<std::string> scenes = scenes_without_tables();
  const std::regex parameter(R"re(<Parameter name="([^"]*)" type="[^"]*" value="([^"]*)"/>\s*)re");
  Mutator mutator;
  Comparison comparison(kUnforeseenInXml);
  for (int i = 0; i < kMutations; ++i) {
    const std::string text = mutator.mutated(
        scenes[mutator.below(scenes.size())], parameter,
        {"-1", "0", "1e6", "0.5", "3000000000", "abc", "", "inf", "true", "{1, 2}", "{0, 0, 0}", "{x, z}", "{x, x}"});
    comparison.add(text, refusal_of(text, "scene.xml"), accepts_xml(text) ? "" : "refused");
  }
  EXPECT_GT(comparison.read, kLeastRead);
  EXPECT_GT(comparison.refused, kLeastRefused);
}

TEST_F(Judgement, MutatedYamlIsJudgedAsByTheReader) {
  std::vector<std::string> scenes, texts;
  for (const std::string& scene : scenes_without_tables()) scenes.push_back(yaml_of(scene));
  const std::regex entry(R"re(([A-Za-z][A-Za-z0-9 ]*): ("[^"\n]*"|\[[^\]]*\]|[^,{}"\[\]\n#]+)(, |(?=\})|\n))re");
  Mutator mutator;
  for (int i = 0; i < kMutations; ++i)
    texts.push_back(mutator.mutated(scenes[mutator.below(scenes.size())], entry,
                                    {"-1", "0", "1.0e+06", "0.5", "3000000000", "abc", "\"\"", "inf", "true", "[1, 2]",
                                     "[0, 0, 0]", "[x, z]", "[x, x]", "\"7\"", "{}", "1.0"}));
  const std::vector<std::string> verdicts = against_yaml(texts);
  Comparison comparison(kUnforeseenInYaml);
  for (std::size_t i = 0; i < texts.size(); ++i)
    comparison.add(texts[i], refusal_of(texts[i], "scene.yaml"), verdicts[i]);
  EXPECT_GT(comparison.read, kLeastRead);
  EXPECT_GT(comparison.refused, kLeastRefused);
}

}  // namespace
}  // namespace mixbeam::judgement_test
