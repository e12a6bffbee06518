// Copies of objects by plain reads and writes. The library's own H5Ocopy crashes in its clean-up where a read fails in
// the midst of it, as of a damaged block.
#include "discretization/results/hdf5_writer.hpp"

#include <algorithm>

namespace mixbeam::hdf5 {

namespace {

constexpr int kDeepest = 8;  // groups below one another, more than results have
/// Held in memory while a dataset is copied.
constexpr std::size_t kMostBytesCopied = std::size_t{8} << 20;

void copy_attribute(hid_t source, const std::string& name, hid_t target) {
  const std::string action = "copy attribute " + name;
  const StoredValues from = open_attribute(source, name, Stored::anything);
  std::vector<char> bytes(from.bytes);
  require(H5Aread(from.id, from.type, bytes.data()), action);
  const Handle to(H5Acreate2(target, name.c_str(), from.type, from.space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, action);
  require(H5Awrite(to, from.type, bytes.data()), action);
}

void copy_attributes(hid_t source, hid_t target) {
  for (const std::string& name : attribute_names(source)) copy_attribute(source, name, target);
}

/// The numbers of a dataset, as many rows at a time as fit.
class RowCopy {
 public:
  RowCopy(const std::string& action, const StoredValues& from, hid_t to)
      : action_(action), from_(from.id), to_(to), type_(from.type), space_(from.space), shape_(from.shape) {}

  void all() {
    hsize_t numbers_in_row = 1;
    for (std::size_t i = 1; i < shape_.size(); ++i) numbers_in_row *= shape_[i];
    const hsize_t row_bytes = std::max<hsize_t>(1, numbers_in_row * H5Tget_size(type_));
    if (shape_.empty()) {
      std::vector<char> bytes(row_bytes);
      return move(H5S_ALL, H5S_ALL, bytes);
    }
    if (numbers_in_row == 0) return;
    const hsize_t most = std::max<hsize_t>(1, kMostBytesCopied / row_bytes);
    std::vector<char> bytes(std::min(most, shape_[0]) * row_bytes);
    for (hsize_t first = 0; first < shape_[0]; first += most) rows(first, std::min(most, shape_[0] - first), bytes);
  }

 private:
  void rows(hsize_t first, hsize_t count, std::vector<char>& bytes) {
    std::vector<hsize_t> start(shape_.size(), 0), part = shape_;
    start[0] = first;
    part[0] = count;
    const Handle memory(H5Screate_simple(static_cast<int>(part.size()), part.data(), nullptr), H5Sclose, action_);
    require(H5Sselect_hyperslab(space_, H5S_SELECT_SET, start.data(), nullptr, part.data(), nullptr), action_);
    move(memory, space_, bytes);
  }
  void move(hid_t memory, hid_t place, std::vector<char>& bytes) {
    require(H5Dread(from_, type_, memory, place, H5P_DEFAULT, bytes.data()), action_);
    require(H5Dwrite(to_, type_, memory, place, H5P_DEFAULT, bytes.data()), action_);
  }

  const std::string& action_;
  hid_t from_, to_, type_, space_;
  std::vector<hsize_t> shape_;
};

void copy_dataset(Handle dataset, const std::string& name, hid_t target) {
  const std::string action = "copy " + name;
  const StoredValues from = values_of(std::move(dataset), name, Stored::anything);
  const Handle creation(H5Dget_create_plist(from.id), H5Pclose, action);
  const Handle to(H5Dcreate2(target, name.c_str(), from.type, from.space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
                  action);
  RowCopy(action, from, to).all();
  copy_attributes(from.id, to);
}

/// `depth`: of groups that may follow; a group that holds itself has no end.
void copy_object(Handle from, const std::string& name, hid_t target, int depth) {
  if (depth < 0) throw Error("cannot copy " + name + ": it lies deeper than results do");
  if (!is_group(from)) return copy_dataset(std::move(from), name, target);
  const Handle to = create_group(target, name);
  copy_attributes(from, to);
  for (const ObjectLink& child : links_of(from)) copy_object(open_object(from, child.name), child.name, to, depth - 1);
}

}  // namespace

void copy_link(hid_t source, const std::string& name, hid_t target) {
  copy_object(open_object(source, name), name, target, kDeepest);
}

}  // namespace mixbeam::hdf5
