// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/store.hpp"

#include <gmock/gmock.h>
#include <hdf5.h>

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "tests/datasets/sample_record.hpp"
#include "tests/datasets/stored_file.hpp"

namespace {

using namespace impactrig::datasets;
using tests::read_error;
using tests::record_of;
using tests::sample_record;
using tests::TemporaryFile;
using tests::written_and_read;

/// Changes a written file behind the writer's back and gives the reader's answer.
class Tampered {
 public:
  explicit Tampered(const Record& record = sample_record()) : file_("tampered.h5") {
    write_record(record, file_.path());
    id_ = H5Fopen(file_.path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  }

  ~Tampered() {
    if (id_ >= 0) H5Fclose(id_);
  }

  Tampered(const Tampered&) = delete;
  Tampered& operator=(const Tampered&) = delete;

  hid_t id() const { return id_; }

  void remove(const char* path) const { ASSERT_GE(H5Ldelete(id_, path, H5P_DEFAULT), 0); }

  void remove_attribute(const char* object, const char* name) const {
    ASSERT_GE(H5Adelete_by_name(id_, object, name, H5P_DEFAULT), 0);
  }

  void put_text(const char* object, const char* name, const char* text) const {
    if (H5Aexists_by_name(id_, object, name, H5P_DEFAULT) > 0) remove_attribute(object, name);
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, std::strlen(text) + 1);
    const hid_t attribute =
        H5Acreate_by_name(id_, object, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    ASSERT_GE(H5Awrite(attribute, type, text), 0);
    H5Aclose(attribute), H5Sclose(space), H5Tclose(type);
  }

  /// A data set that holds nothing yet.
  void put_data(const char* path, hid_t type, const std::vector<hsize_t>& shape,
                hid_t properties = H5P_DEFAULT) const {
    if (H5Lexists(id_, path, H5P_DEFAULT) > 0) remove(path);
    const hid_t space =
        shape.empty() ? H5Screate(H5S_SCALAR)
                      : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t data = H5Dcreate2(id_, path, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    ASSERT_GE(data, 0);
    H5Dclose(data), H5Sclose(space);
  }

  std::string answer() {
    H5Fclose(id_);
    id_ = -1;
    return read_error(file_.path());
  }

 private:
  TemporaryFile file_;
  hid_t id_ = -1;
};

TEST(StoreRead, RefusesHdf5FilesOfOthers) {
  const std::string refusal =
      "is an HDF5 file, but not a recording of impactrig: its root has no attribute 'format' that "
      "says 'impactrig-recording'";
  const TemporaryFile file("others.h5");
  H5Fclose(H5Fcreate(file.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_EQ(read_error(file.path()), refusal);

  Tampered tampered;
  tampered.put_text("/", "format", "impactrig-recordings");
  EXPECT_EQ(tampered.answer(), refusal);

  // with a header of its own before HDF5's, as MATLAB 7.3 writes
  const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_userblock(creation, 512);
  H5Fclose(H5Fcreate(file.path().c_str(), H5F_ACC_TRUNC, creation, H5P_DEFAULT));
  H5Pclose(creation);
  EXPECT_EQ(read_error(file.path()), refusal);
}

TEST(StoreRead, RefusesALaterFormat) {
  Tampered later;
  later.put_text("/", "format_version", "2.0");
  later.put_text("/", "creator", "impactrig 9.1.0");
  EXPECT_EQ(later.answer(),
            "has format 2.0 of recordings, written by impactrig 9.1.0; this is " +
                program_version() +
                ", which reads format 1.0 and what came before: update it, or write the file again "
                "with the older program");
  for (const char* wrong : {"", "1", "x.1", "-1.0", "99999999999999999999.0"}) {
    Tampered tampered;
    tampered.put_text("/", "format_version", wrong);
    EXPECT_EQ(tampered.answer(),
              "is damaged: /@format_version is '" + std::string(wrong) + "', not a version");
  }
}

TEST(StoreRead, TakesALaterMinorFormatAndWhatItDoesNotKnow) {
  Tampered later;
  later.put_text("/", "format_version", "1.7");
  later.put_data("/entry/novelty", H5T_NATIVE_DOUBLE, {3});
  EXPECT_EQ(later.answer(), "read");
}

TEST(StoreRead, TakesAnUnknownQuantityAndSaysSo) {
  const TemporaryFile file("quantity.h5");
  write_record(record_of(std::vector<double>{1.0}), file.path());
  const hid_t id = H5Fopen(file.path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Ldelete(id, "/entry/raw/a/quantity", H5P_DEFAULT);
  const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
  H5Tset_size(type, 8);
  H5Tset_strpad(type, H5T_STR_SPACEPAD);
  const hid_t data =
      H5Dcreate2(id, "/entry/raw/a/quantity", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, "torque  ");
  H5Dclose(data), H5Sclose(space), H5Tclose(type), H5Fclose(id);
  const Record record = read_record(file.path());
  EXPECT_EQ(record.channels[0].quantity, Quantity::other);
  EXPECT_THAT(record.warnings,
              testing::ElementsAre("Channel 'a': this program does not know its quantity 'torque' "
                                   "and takes it as 'other'."));
}

TEST(StoreRead, NamesWhatIsMissing) {
  for (const char* path :
       {"/entry", "/entry/title", "/entry/raw", "/entry/calibration", "/entry/provenance",
        "/entry/provenance/sha256", "/entry/raw/force/name", "/entry/raw/force/samples",
        "/entry/calibration/force/source", "/entry/calibration/force/delay_errors"}) {
    Tampered tampered;
    tampered.remove(path);
    EXPECT_EQ(tampered.answer(), "is damaged: " + std::string(path) + " is missing");
  }
  Tampered tampered;
  tampered.remove_attribute("/entry/raw/force/samples", "scale_factor");
  EXPECT_EQ(tampered.answer(), "is damaged: /entry/raw/force/samples@scale_factor is missing");
}

TEST(StoreRead, NamesWhatIsOfAnotherKind) {
  const auto answer = [](const std::function<void(Tampered&)>& change) {
    Tampered tampered;
    change(tampered);
    return tampered.answer();
  };
  EXPECT_EQ(answer([](auto& file) { file.put_data("/entry/raw", H5T_NATIVE_DOUBLE, {3}); }),
            "is damaged: /entry/raw is not a group");
  EXPECT_EQ(
      answer([](auto& file) {
        file.remove("/entry/title");
        H5Gclose(H5Gcreate2(file.id(), "/entry/title", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
      }),
      "is damaged: /entry/title is not a data set");
  EXPECT_EQ(answer([](auto& file) { file.put_data("/entry/title", H5T_NATIVE_DOUBLE, {}); }),
            "is damaged: /entry/title declares 1 values and holds 0 bytes");
  EXPECT_EQ(answer([](auto& file) { file.put_text("/entry/raw/force/samples", "start", "0 s"); }),
            "is damaged: /entry/raw/force/samples@start is not one number");
  EXPECT_EQ(answer([](auto& file) {
              const hid_t text = H5Tcopy(H5T_C_S1);
              H5Tset_size(text, H5T_VARIABLE);
              file.put_data("/entry/warnings", text, {0});
              H5Tclose(text);
            }),
            "is damaged: /entry/warnings is not text of a fixed length");
  EXPECT_EQ(answer([](auto& file) {
              file.put_data("/entry/raw/h1/samples", H5T_NATIVE_DOUBLE, {2, 2});
            }),
            "is damaged: /entry/raw/h1/samples has another shape than it must have");
  EXPECT_EQ(
      answer([](auto& file) { file.put_data("/entry/raw/h1/samples", H5T_NATIVE_UINT16, {0}); }),
      "is damaged: /entry/raw/h1/samples is of a number type that no recording has");
  EXPECT_EQ(answer([](auto& file) { file.put_data("/entry/raw/h1/samples", H5T_C_S1, {0}); }),
            "is damaged: /entry/raw/h1/samples is of a number type that no recording has");
  EXPECT_EQ(answer([](auto& file) { file.put_data("/entry/raw/h1/imaginary", H5T_C_S1, {0}); }),
            "is damaged: /entry/raw/h1/imaginary is not made of numbers");
  EXPECT_EQ(
      answer([](auto& file) { file.put_data("/entry/raw/h1/imaginary", H5T_NATIVE_DOUBLE, {0}); }),
      "is damaged: /entry/raw/h1/imaginary has 0 values for 3 samples");
  EXPECT_EQ(answer([](auto& file) { file.put_data("/entry/warnings", H5T_NATIVE_DOUBLE, {0}); }),
            "is damaged: /entry/warnings is not text of a fixed length");
}

TEST(StoreRead, DoesNotFollowLinksOutOfTheFile) {
  Tampered link;
  link.remove("/entry/provenance");
  ASSERT_GE(H5Lcreate_external("/absent/other.h5", "/", link.id(), "/entry/provenance", H5P_DEFAULT,
                               H5P_DEFAULT),
            0);
  EXPECT_EQ(link.answer(), "is damaged: /entry/provenance is a link");

  Tampered outside;
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(properties, "/absent/other.bin", 0, 24);
  outside.put_data("/entry/raw/h1/samples", H5T_NATIVE_DOUBLE, {3}, properties);
  H5Pclose(properties);
  EXPECT_EQ(outside.answer(), "is damaged: /entry/raw/h1/samples is kept in another file");
}

TEST(StoreRead, TakesNoMemoryForWhatAFileOnlyDeclares) {
  const std::string large = std::to_string(hsize_t{1} << 45);
  Tampered contiguous;
  contiguous.put_data("/entry/raw/h1/samples", H5T_NATIVE_DOUBLE, {hsize_t{1} << 45});
  EXPECT_EQ(contiguous.answer(),
            "is damaged: /entry/raw/h1/samples declares " + large + " values and holds 0 bytes");

  Tampered chunked;
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  const hsize_t chunk = hsize_t{1} << 28;
  H5Pset_chunk(properties, 1, &chunk);
  chunked.put_data("/entry/raw/h1/samples", H5T_NATIVE_DOUBLE, {hsize_t{1} << 45}, properties);
  H5Pclose(properties);
  EXPECT_EQ(chunked.answer(),
            "is damaged: /entry/raw/h1/samples declares " + large + " values and holds 0 bytes");

  Tampered texts;
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, 80);
  texts.put_data("/entry/warnings", text, {hsize_t{1} << 45});
  H5Tclose(text);
  EXPECT_EQ(texts.answer(),
            "is damaged: /entry/warnings declares " + large + " values and holds 0 bytes");
}

TEST(Store, ClosesAllItOpens) {
  const auto open_now = [] {
    hsize_t sum = 0;
    for (const H5I_type_t type : {H5I_FILE, H5I_GROUP, H5I_DATATYPE, H5I_DATASPACE, H5I_DATASET,
                                  H5I_ATTR, H5I_GENPROP_LST}) {
      hsize_t members = 0;
      H5Inmembers(type, &members);
      sum += members;
    }
    return sum;
  };
  EXPECT_EQ(written_and_read(sample_record(), "ids.h5").channels.size(), 3u);
  const hsize_t before = open_now();
  EXPECT_EQ(written_and_read(sample_record(), "ids.h5").channels.size(), 3u);
  EXPECT_EQ(open_now(), before);
  Tampered tampered;
  tampered.remove("/entry/provenance/sha256");
  EXPECT_EQ(tampered.answer(), "is damaged: /entry/provenance/sha256 is missing");
  EXPECT_EQ(open_now(), before);
}

}  // namespace
