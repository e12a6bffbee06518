#include "discretization/results/result_tables.hpp"

#include "discretization/state/record_fields.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/tags.hpp"

#include <algorithm>
#include <utility>

namespace mixbeam {

namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ && sizeof(int) == 4,
              "numbers go into the file as they are in memory");

constexpr int kXdmfPolyline = 2;  // XDMF's number for a polyline in a mixed topology

template <class Number>
constexpr TableNumbers kNumbersOf = TableNumbers::doubles;
template <>
constexpr TableNumbers kNumbersOf<int> = TableNumbers::integers;

/// Writes rows of a table: rows that follow one another are collected in the buffer of the file. One at a time for each
/// file.
template <class Number>
class RowWriter {
 public:
  /// `offset`: of the first row in the file. A row has `columns` numbers.
  RowWriter(TableWriter& file, std::uint64_t offset, std::size_t columns)
      : file_(file),
        offset_(offset),
        columns_(columns),
        most_rows_(TableWriter::kBufferBytes / (columns * sizeof(Number))) {}

  /// Room for the numbers of a row, to be filled before the next call.
  Number* row(std::size_t number) {
    if (number != first_ + rows_ || rows_ == most_rows_) {
      finish();
      first_ = number;
    }
    return reinterpret_cast<Number*>(file_.buffer()) + columns_ * rows_++;
  }

  /// Writes the remaining rows. To be called at the end.
  void finish() {
    if (rows_ == 0) return;
    const std::size_t bytes_of_row = columns_ * sizeof(Number);
    file_.write(offset_ + first_ * bytes_of_row, file_.buffer(), rows_ * bytes_of_row);
    rows_ = 0;
  }

 private:
  TableWriter& file_;
  std::uint64_t offset_;
  std::size_t columns_, most_rows_;
  std::size_t first_ = 0, rows_ = 0;  ///< collected
};

/// `fill` gives the rows of this rank to a RowWriter<Number>.
template <class Number, class Fill>
ResultTable table(const std::string& name, std::size_t rows, std::size_t columns, const Fill& fill) {
  return {{name, kNumbersOf<Number>, rows, columns}, [columns, fill](TableWriter& file, std::uint64_t offset) {
            RowWriter<Number> writer(file, offset, columns);
            fill(writer);
            writer.finish();
          }};
}

/// Calls action(row of the table, position among the rows that are held).
template <class Action>
void for_each_held(const RowShare& share, const Action& action) {
  std::size_t held = 0;
  for (const RowRun& run : share.runs)
    for (std::size_t row = run.first; row < run.first + run.count; ++row) action(row, held++);
}

/// Table of numbers that are held in the layout of the file; `values`: the first of them.
template <class Number>
ResultTable table_of(const std::string& name, const RowShare& share, std::size_t columns, const Number* values) {
  const std::size_t row = columns * sizeof(Number);
  return {{name, kNumbersOf<Number>, share.rows, columns},
          [share, row, columns, values](TableWriter& file, std::uint64_t offset) {
            const Number* from = values;
            for (const RowRun& run : share.runs) {
              file.write(offset + run.first * row, from, run.count * row);
              from += run.count * columns;
            }
          }};
}

const double* numbers_of(const std::vector<Vector3>& vectors) {
  static_assert(sizeof(Vector3) == 3 * sizeof(double), "vectors are written as rows of three numbers");
  return vectors.empty() ? nullptr : vectors.front().data();
}

/// Table of `values`, which every rank has, and of which it writes a part.
template <class Number>
ResultTable known_table(const std::string& name, RankNumber rank, std::size_t columns, std::size_t rows,
                        const Number* values) {
  const RowShare share = even_share(rows, rank.rank, rank.ranks);
  const std::size_t first = share.runs.empty() ? 0 : share.runs.front().first;
  return table_of(name, share, columns, values + columns * first);
}

/// A field at the samples of all members: value(member, index of a held sample, room for its numbers).
template <class Number = double, class Value>
ResultTable sample_table(const std::string& name, std::size_t columns, const SampledMembers& members,
                         const Value& value) {
  return table<Number>(name, members.samples(), columns, [&members, value](RowWriter<Number>& writer) {
    for (const MemberSamples& member : members)
      for_each_held(member.share, [&](std::size_t row, std::size_t held) {
        value(member, held, writer.row(member.first_sample + row));
      });
  });
}

/// A field of numbers, or of rows of them.
template <class Row>
ResultTable field_table(const std::string& name, const SampledMembers& members,
                        std::vector<Row> MemberSamples::*field) {
  constexpr std::size_t kColumns = sizeof(Row) / sizeof(double);
  return sample_table(name, kColumns, members, [field](const MemberSamples& member, std::size_t sample, double* row) {
    std::copy_n(reinterpret_cast<const double*>(&(member.*field)[sample]), kColumns, row);
  });
}

// Columns g1, g2, g3 of the rotation matrix of a unit quaternion, spatial components.
std::array<Vector3, 3> triad_vectors(const TriadQuaternion& triad) {
  const auto [w, x, y, z] = triad;
  return {Vector3{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
          Vector3{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
          Vector3{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
}

// Spatial components of a material vector field: v = sum_i V_i g_i at every sample.
ResultTable spatial_table(const std::string& name, const SampledMembers& members,
                          std::vector<Vector3> MemberSamples::*material) {
  return sample_table(name, 3, members, [material](const MemberSamples& member, std::size_t sample, double* row) {
    const auto g = triad_vectors(member.triad[sample]);
    const Vector3& v = (member.*material)[sample];
    for (std::size_t i = 0; i < 3; ++i) row[i] = v[0] * g[0][i] + v[1] * g[1][i] + v[2] * g[2][i];
  });
}

ResultTable triad_table(const std::string& name, const SampledMembers& members, std::size_t column) {
  return sample_table(name, 3, members, [column](const MemberSamples& member, std::size_t sample, double* row) {
    const Vector3 g = triad_vectors(member.triad[sample])[column];
    std::copy(g.begin(), g.end(), row);
  });
}

/// For each member 2, its number of samples, their numbers: a rank writes those of its samples, and the first two with
/// the first sample.
ResultTable connectivity_table(const SampledMembers& members) {
  constexpr std::size_t kHead = 2;
  const std::size_t rows = members.samples() + kHead * members.members();
  return table<int>("/polyline/connectivity", rows, 1, [&members](RowWriter<int>& writer) {
    for (const MemberSamples& member : members) {
      const std::size_t begin = member.first_sample + kHead * static_cast<std::size_t>(member.number);
      for_each_held(member.share, [&](std::size_t row, std::size_t) {
        if (row == 0) {
          *writer.row(begin) = kXdmfPolyline;
          *writer.row(begin + 1) = static_cast<int>(member.share.rows);
        }
        *writer.row(begin + kHead + row) = static_cast<int>(member.first_sample + row);
      });
    }
  });
}

RowShare share_of_samples(const SampledMembers& members) {
  RowShare all{members.samples()};
  for (const MemberSamples& member : members)
    for (const RowRun& run : member.share.runs) all.hold(member.first_sample + run.first, run.count);
  return all;
}

void add_fields(const std::string& group, const SampledMembers& members, std::vector<ResultTable>& tables) {
  const auto add = [&](const char* name, auto field) { tables.push_back(field_table(group + name, members, field)); };
  add("position", &MemberSamples::position);
  add("displacement", &MemberSamples::displacement);
  add("triad", &MemberSamples::triad);
  add("force_strain", &MemberSamples::force_strain);
  add("moment_strain", &MemberSamples::moment_strain);
  add("material_force", &MemberSamples::material_force);
  add("material_moment", &MemberSamples::material_moment);
  tables.push_back(spatial_table(group + "spatial_force", members, &MemberSamples::material_force));
  tables.push_back(spatial_table(group + "spatial_moment", members, &MemberSamples::material_moment));
  for (std::size_t i = 0; i < 3; ++i)
    tables.push_back(triad_table(group + "triad_" + std::to_string(i + 1), members, i));
}

/// In the order of kStressNames.
constexpr std::array<std::vector<double> MemberSamples::*, kStressNames.size()> kStresses = {
    &MemberSamples::largest_normal_stress, &MemberSamples::largest_shear_stress, &MemberSamples::von_mises_stress,
    &MemberSamples::utilisation};

void add_state(const std::string& group, const StateShare& state, std::vector<ResultTable>& tables) {
  const StateSnapshot& held = state.held;
  tables.push_back(table_of(group + "vertex_displacement", state.vertices, 3, held.vertex_displacement.data()));
  tables.push_back(table_of(group + "vertex_rotation", state.vertices, 4, held.vertex_rotation.data()));
  tables.push_back(table_of(group + "element_triad", state.elements, 4, held.element_triad.data()));
  tables.push_back(table_of(group + "interior", state.interior, 1, held.interior.data()));
}

void add_error_estimate(const std::string& group, const RecordedErrorEstimate& estimate, RankNumber rank,
                        std::vector<ResultTable>& tables) {
  const auto& u = estimate.vertex_displacement;
  const auto &of_u = estimate.element_displacement, &of_moment = estimate.element_moment;
  tables.push_back(known_table(group + "vertex_displacement", rank, 3, u.size(), numbers_of(u)));
  tables.push_back(known_table(group + "element_displacement", rank, 1, of_u.size(), of_u.data()));
  tables.push_back(known_table(group + "element_moment", rank, 1, of_moment.size(), of_moment.data()));
}

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

std::string step_group_name(int step) {
  std::string digits = std::to_string(step);
  return std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits;
}

std::vector<std::string> stresses_of_step(const StepRecord& record) {
  if (!record.stresses || record.stresses->members.empty()) return {};
  std::vector<std::string> names(kStressNames.begin(), kStressNames.end());
  if (!record.stresses->has_strength) names.pop_back();
  return names;
}

std::vector<ResultTable> tables_of_members(const SampledMembers& members) {
  const std::string group = "/members/";
  const auto arc_length = [](const MemberSamples& member, std::size_t i, double* row) { *row = member.arc_length[i]; };
  const auto element = [](const MemberSamples& member, std::size_t i, int* row) { *row = member.element[i]; };
  return {sample_table(group + "arc_length", 1, members, arc_length),
          sample_table<int>(group + "element", 1, members, element),
          field_table(group + "reference_position", members, &MemberSamples::reference_position),
          connectivity_table(members)};
}

std::vector<ResultTable> tables_of_step(const StepRecord& record, RankNumber rank) {
  std::vector<ResultTable> tables;
  const RowShare samples = share_of_samples(record.members);
  const auto add = [&](const std::string& name, const std::vector<Vector3>& vectors) {
    tables.push_back(table_of(name, samples, 3, numbers_of(vectors)));
  };
  const auto add_fields_of = [&](const std::string& group, const auto& one) {
    visit_fields(one, [&](const auto& field, const auto& value) {
      if constexpr (kIsAtSamples<decltype(value)>) add(group + field.name, value);
    });
  };
  const std::string group = "/steps/" + step_group_name(record.step) + "/";
  const std::string buckling = record.step == 0 ? "/buckling/" : group + "buckling/";
  for (std::size_t i = 0; i < record.buckling.size(); ++i)
    add_fields_of(buckling + std::to_string(i) + "/", record.buckling[i]);
  for (std::size_t i = 0; i < record.vibration.size(); ++i)
    add_fields_of(group + "vibration/" + std::to_string(i) + "/", record.vibration[i]);
  add_fields(group, record.members, tables);
  const std::vector<std::string> stresses = stresses_of_step(record);
  for (std::size_t i = 0; i < stresses.size(); ++i)
    tables.push_back(field_table(group + stresses[i], record.members, kStresses[i]));
  for (std::size_t i = 0; i < record.critical_points.size(); ++i) {
    const RecordedCriticalPoint& point = record.critical_points[i];
    const std::string inside = group + "critical_points/" + std::to_string(i) + "/";
    add_fields_of(inside, point);
    if (!point.state.empty()) add_state(inside + "state/", point.state, tables);
  }
  if (record.error_estimate && record.error_estimate->not_estimated.empty())
    add_error_estimate(group + "error_estimate/", *record.error_estimate, rank, tables);
  if (!record.state.empty()) add_state(group + "state/", record.state, tables);
  return tables;
}

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
