#include "discretization/results/table_file.hpp"

#include "discretization/results/hdf5_writer.hpp"
#include "discretization/text/errors.hpp"

namespace mixbeam {

namespace {

/// Writes a column into the groups in its name, which are made if they are missing.
void write_column(hid_t parent, const std::string& name, const std::vector<double>& values) {
  const std::size_t slash = name.find('/');
  if (slash == std::string::npos) return hdf5::write_dataset(parent, name, values, 1);
  const std::string group_name = name.substr(0, slash);
  const bool exists = hdf5::has_link(parent, group_name);
  const hdf5::Handle group = exists ? hdf5::open_group(parent, group_name) : hdf5::create_group(parent, group_name);
  write_column(group, name.substr(slash + 1), values);
}

}  // namespace

void write_table_file(const std::filesystem::path& path, const std::vector<TableColumn>& columns,
                      const std::map<std::string, std::string>& texts, const std::string& group) {
  const hdf5::QuietScope quiet;
  try {
    Replacement replacement(path);
    DiskFile file(replacement.hidden_path(), DiskAccess::create);
    Seal seal;
    GuardedFile content(file, seal);
    hdf5::File table(content, hdf5::FileUse::create);
    for (const auto& [name, text] : texts) hdf5::write_text(table, name, text);
    {
      const hdf5::Handle parent = hdf5::create_group(table, group);
      for (const TableColumn& column : columns)
        write_column(parent, column.name, column.later ? column.later() : column.values);
    }
    table.close();
    file.reserve(seal.bytes + seal.bytes_behind());
    content.flush();
    write_seal(file, seal);
    file.close();
    const bool durable = true;
    replacement.publish(durable);
  } catch (const std::exception& error) {
    throw ResultFileError("result file " + path.string() + ": " + reason_of(error));
  }
}

}  // namespace mixbeam
