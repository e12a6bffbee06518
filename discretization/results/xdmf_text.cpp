#include "discretization/results/result_tables.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/tags.hpp"

#include <array>

namespace mixbeam {
namespace {

constexpr std::array<const char*, 10> kVectorFields = {
    "displacement", "spatial_force",  "spatial_moment",  "triad_1",      "triad_2",
    "triad_3",      "material_force", "material_moment", "force_strain", "moment_strain"};

std::string data_item(const std::string& dimensions, const std::string& type, const std::string& place) {
  return "<DataItem Format=\"HDF\" " + type + " Dimensions=\"" + dimensions + "\">" + place + "</DataItem>";
}

std::string step_grid(const std::string& file, const XdmfStep& step, std::size_t members, std::size_t samples,
                      std::size_t connectivity) {
  const std::string vectors = std::to_string(samples) + " 3";
  const std::string real = "NumberType=\"Float\" Precision=\"8\"";
  const std::string place = file + ":/steps/" + step_group_name(step.step) + "/";
  std::string text = "      <Grid Name=\"step " + std::to_string(step.step) + "\" GridType=\"Uniform\">\n";
  text += "        <Time Value=\"" + std::to_string(step.step) + "\"/>\n";
  text +=
      "        <Topology TopologyType=\"Mixed\" NumberOfElements=\"" + std::to_string(members) + "\">" +
      data_item(std::to_string(connectivity), "NumberType=\"Int\" Precision=\"4\"", file + ":/polyline/connectivity") +
      "</Topology>\n";
  text += "        <Geometry GeometryType=\"XYZ\">" + data_item(vectors, real, place + "position") + "</Geometry>\n";
  for (const char* field : kVectorFields) {
    text += "        <Attribute Name=\"" + std::string(field) + "\" AttributeType=\"Vector\" Center=\"Node\">" +
            data_item(vectors, real, place + field) + "</Attribute>\n";
  }
  for (const std::string& field : step.stresses) {
    text += "        <Attribute Name=\"" + field + "\" AttributeType=\"Scalar\" Center=\"Node\">" +
            data_item(std::to_string(samples), real, place + field) + "</Attribute>\n";
  }
  text += "        <Attribute Name=\"load_factor\" AttributeType=\"Scalar\" Center=\"Grid\"><DataItem Format=\"XML\" " +
          real + " Dimensions=\"1\">" + shortest(step.load_factor) + "</DataItem></Attribute>\n";
  return text + "      </Grid>\n";
}

}  // namespace

void write_xdmf_text(const TextSink& sink, const std::string& data_file, const std::vector<XdmfStep>& steps,
                     std::size_t members, std::size_t samples, std::size_t connectivity) {
  constexpr std::size_t kPiece = std::size_t{1} << 16;
  const std::string file = xml_escaped(data_file);
  std::string text =
      "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
      "    <Grid Name=\"steps\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (const auto& step : steps) {
    text += step_grid(file, step, members, samples, connectivity);
    if (text.size() < kPiece) continue;
    sink(text);
    text.clear();
  }
  sink(text + "    </Grid>\n  </Domain>\n</Xdmf>\n");
}

}  // namespace mixbeam
