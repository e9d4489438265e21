// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>

#include "tests/acquisition/hdf5_bytes.hpp"
#include "tests/acquisition/written_file.hpp"

namespace impactrig::acquisition {
namespace {

using datasets::Channel;
using datasets::Record;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::Hdf5File;
using tests::imported;
using tests::names_and_units;

/// A data set as PyTables writes it.
void axis(const Hdf5File& file, const std::string& path, const std::string& kind,
          const std::string& name) {
  file.text(path, "CLASS", "ARRAY");
  file.text(path, "kind", kind);
  file.text(path, "name", name.empty() ? "N." : name);
}

/// DataFrame.to_hdf(format="fixed") but for its index: two columns of doubles, one of floats.
void fixed_frame(const Hdf5File& file) {
  file.group("/shot1");
  file.text("/shot1", "pandas_type", "frame");
  file.text_list("/shot1/axis0", {"force_N", "disp_um", "velocity_mps"});
  file.text_list("/shot1/block0_items", {"force_N", "disp_um"});
  file.data<double>("/shot1/block0_values", {3, 2}, {1.0, 10.0, 2.0, 20.0, 3.0, 30.0},
                    H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.text_list("/shot1/block1_items", {"velocity_mps"});
  file.data<float>("/shot1/block1_values", {3, 1}, {0.5F, 0.25F, -0.5F}, H5T_NATIVE_FLOAT,
                   H5T_IEEE_F32LE);
}

TEST(Hdf5OfPandas, AFixedFrameHasItsColumnsOverItsIndex) {
  const Hdf5File file;
  fixed_frame(file);
  file.doubles("/shot1/axis1", {0.0, 0.5, 1.0});
  axis(file, "/shot1/axis1", "float", "time_ms");
  const Record record = imported(file.bytes(), {}, ".h5");
  EXPECT_THAT(names_and_units(record),
              ElementsAre("/shot1.time_ms [ms]", "/shot1.force_N [N]", "/shot1.disp_um [um]",
                          "/shot1.velocity_mps [mps]"));
  EXPECT_THAT(record.warnings, IsEmpty());
  EXPECT_THAT(record.channels[2].values(), ElementsAre(10.0, 20.0, 30.0));
  EXPECT_THAT(record.channels[3].values(), ElementsAre(0.5, 0.25, -0.5));
  EXPECT_EQ(record.channels[3].quantity, datasets::Quantity::velocity);
  for (const Channel& channel : record.channels)
    EXPECT_DOUBLE_EQ(channel.clock.interval, 5e-4) << channel.name;
}

TEST(Hdf5OfPandas, AnIndexOfDatesIsTheTime) {
  for (const auto& [kind, per_second] :
       {std::pair{"datetime64", 1e9}, {"datetime64[us]", 1e6}, {"timedelta64[ms]", 1e3}}) {
    const Hdf5File file;
    fixed_frame(file);
    const auto step = static_cast<std::int64_t>(per_second / 100.0);
    const std::int64_t first = std::string_view(kind).starts_with("date") ? 170925120 * step : 0;
    file.data<std::int64_t>("/shot1/axis1", {3}, {first, first + step, first + 2 * step},
                            H5T_NATIVE_INT64, H5T_STD_I64LE);
    axis(file, "/shot1/axis1", kind, "");
    const Record record = imported(file.bytes(), {}, ".h5");
    ASSERT_EQ(record.channels.size(), 4U);
    EXPECT_EQ(record.channels[0].name, "/shot1.index");
    EXPECT_NEAR(record.channels[1].clock.interval, 0.01, 1e-9) << kind;
  }
}

TEST(Hdf5OfPandas, AnIndexThatCountsRowsIsNoTime) {
  const Hdf5File file;
  fixed_frame(file);
  file.data<std::int64_t>("/shot1/axis1", {3}, {0, 1, 2}, H5T_NATIVE_INT64, H5T_STD_I64LE);
  axis(file, "/shot1/axis1", "integer", "");
  const Record record = imported(file.bytes(), {}, ".h5");
  ASSERT_EQ(record.channels.size(), 4U);
  EXPECT_EQ(record.channels[1].clock.interval, 0.0);
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("have neither times nor a sample rate")));
}

// pandas 1.5.3, of an index of two levels: what the rows hold of each, and where in it.
TEST(Hdf5OfPandas, AnIndexOfSeveralLevelsIsNoChannel) {
  const Hdf5File file;
  fixed_frame(file);
  file.text("/shot1", "axis1_variety", "multi");
  file.text("/shot1", "axis0_variety", "multi");
  file.data<std::int64_t>("/shot1/axis1_level0", {2}, {1, 2}, H5T_NATIVE_INT64, H5T_STD_I64LE);
  file.text_list("/shot1/axis0_level0", {"bar", "stop"});
  file.text_list("/shot1/block0_items_level0", {"bar", "stop"});
  for (const char* labels : {"/shot1/axis1_label0", "/shot1/axis0_label0"})
    file.data<std::int8_t>(labels, {3}, {0, 0, 1}, H5T_NATIVE_INT8, H5T_STD_I8LE);
  const Record record = imported(file.bytes(), {}, ".h5");
  EXPECT_THAT(names_and_units(record), ElementsAre("/shot1.force_N [N]", "/shot1.disp_um [um]",
                                                   "/shot1.velocity_mps [mps]"));
  EXPECT_THAT(record.warnings,
              Contains("not read: '/shot1/axis1' (an index of several levels: reset_index() makes "
                       "columns of it), '/shot1/axis0' (names of several levels: columns are "
                       "numbered)"));
}

TEST(Hdf5OfPandas, ASeriesHasItsName) {
  const Hdf5File file;
  file.group("/run");
  file.text("/run", "pandas_type", "series");
  file.text("/run", "name", "force_N");
  file.doubles("/run/index", {0.0, 0.5, 1.0});
  axis(file, "/run/index", "float", "time_s");
  file.doubles("/run/values", {1.0, 2.0, 3.0});
  const Record record = imported(file.bytes(), {}, ".h5");
  EXPECT_THAT(names_and_units(record), ElementsAre("/run.time_s [s]", "/run.force_N [N]"));
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 0.5);
}

// DataFrame.to_hdf(format="table") keeps the names of each block's columns as a pickle.
TEST(Hdf5OfPandas, ATableHasTheNamesOfItsBlocks) {
  const Hdf5File file;
  file.group("/shot1");
  file.text("/shot1", "pandas_type", "frame_table");
  file.text("/shot1", "info",
            "(dp0\nI1\n(dp1\nVnames\np2\n(lp3\nNasVindex\np6\n(dp7\nVindex_name\np8\nVtime "
            "[ms]\np9\nssVvalues_block_0\np10\n(dp11\ns.");
  file.records_of_lists("/shot1/table", 70);
  file.text("/shot1/table", "index_kind", "float");
  file.text("/shot1/table", "values_block_0_kind",
            "(lp0\nVforce, left [N]\np1\naVslip p1 [um]\np2\na.");
  file.text("/shot1/table", "values_block_1_kind", "(lp0\nVv [m/s]\np1\na.");
  file.group("/shot1/_i_table");
  file.doubles("/shot1/_i_table/sorted", {3.0, 2.0, 1.0});
  const Record record = imported(file.bytes(), {}, ".h5");
  EXPECT_THAT(names_and_units(record),
              ElementsAre("/shot1.time [ms] [ms]", "/shot1.force, left [N] [N]",
                          "/shot1.slip p1 [um] [um]", "/shot1.v [m/s] [m/s]"));
  EXPECT_THAT(record.warnings, IsEmpty());
  for (std::size_t i = 0; i < 70; ++i) {
    const auto k = static_cast<double>(i);
    EXPECT_EQ(record.channels[1].value(i), k * k);
    EXPECT_EQ(record.channels[2].value(i), -k);
    EXPECT_EQ(record.channels[3].value(i), k + 0.5);
  }
  EXPECT_DOUBLE_EQ(record.channels[3].clock.interval, 0.25e-3);
}

TEST(Hdf5OfPandas, NamesMayBeOfAnyLettersOrNumbers) {
  const Hdf5File file;
  file.group("/run");
  file.text("/run", "pandas_type", "frame_table");
  file.records_of_lists("/run/table", 5);
  file.text("/run/table", "values_block_0_kind",
            "(lp0\nVKraft \\u0394\np1\naVgr\u00F6\u00DFe\np2\na.");
  file.text("/run/table", "values_block_1_kind", "(lp0\nI7\na.");
  EXPECT_THAT(
      names_and_units(imported(file.bytes(), {}, ".h5")),
      ElementsAre("/run.index []", "/run.Kraft \u0394 []", "/run.gr\u00F6\u00DFe []", "/run.7 []"));
}

TEST(Hdf5OfPandas, AFixedFrameMayHaveFewRowsOrNone) {
  const Hdf5File file;
  file.group("/run");
  file.text("/run", "pandas_type", "frame");
  file.text_list("/run/block0_items", {"force", "speed", "slip"});
  file.data<double>("/run/block0_values", {1, 3}, {1.0, 2.0, 3.0}, H5T_NATIVE_DOUBLE,
                    H5T_IEEE_F64LE);
  file.data<double>("/run/block1_values", {1}, {1.5e-323}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.text("/run/block1_values", "value_type", "float64");
  file.text("/run/block1_values", "shape", "(I0\nI3\ntp0\n.");
  const Record record = imported(file.bytes(), {}, ".h5");
  EXPECT_THAT(names_and_units(record),
              ElementsAre("/run.force []", "/run.speed []", "/run.slip []"));
  EXPECT_EQ(record.channels[2].value(0), 3.0);
  EXPECT_THAT(record.warnings, testing::Contains("not read: '/run/block1_values' (empty)"));
}

TEST(Hdf5OfPandas, NamesThatCannotBeReadAreThoseOfTheFile) {
  for (const char* pickle : {"(lp0\nVforce\np1\na.", "(lp0\nVforce\np1\naF5\na.", "(lp0\n", ""}) {
    const Hdf5File file;
    file.group("/shot1");
    file.text("/shot1", "pandas_type", "frame_table");
    file.records_of_lists("/shot1/table", 5);
    if (*pickle != 0) file.text("/shot1/table", "values_block_0_kind", pickle);
    const Record record = imported(file.bytes(), {}, ".h5");
    ASSERT_EQ(record.channels.size(), 4U);
    EXPECT_EQ(record.channels[2].name, "/shot1/table.values_block_0:2") << pickle;
  }
}

TEST(Hdf5, ListsInRecordsAreAChannelAnElement) {
  const Hdf5File file;
  file.records_of_lists("/rows", 100'000);
  const Record record = imported(file.bytes(), {}, ".h5");
  EXPECT_THAT(names_and_units(record),
              ElementsAre("/rows.index []", "/rows.values_block_0:1 []",
                          "/rows.values_block_0:2 []", "/rows.values_block_1 []"));
  for (const std::size_t i : {0U, 65'535U, 65'536U, 99'999U})
    EXPECT_EQ(record.channels[2].value(i), -static_cast<double>(i));
}

TEST(Hdf5, ListsBesideCountNothingWhereTheDataSetStatesItsOwn) {
  const Hdf5File file;
  file.group("/run");
  file.data<double>("/run/data", {3, 2}, {0, 1, 2, 3, 4, 5}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.texts("/run/data", "labels", {"x", "y"});
  file.text("/run/data", "units", "N");
  file.data<double>("/run/square", {2, 2}, {0, 1, 2, 3}, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.text_list("/run/columns", {"a", "b"});
  file.text_list("/run/units", {"m", "s"});
  const Record record = imported(file.bytes(), {}, ".h5");
  EXPECT_THAT(names_and_units(record), ElementsAre("/run/data.x [N]", "/run/data.y [N]",
                                                   "/run/square:1 []", "/run/square:2 []"));
  EXPECT_THAT(record.warnings,
              testing::Contains("not read: '/run/columns' (text), '/run/units' (text)"));
}

TEST(Hdf5, NamesAndUnitsMayStandInDataSetsBeside) {
  const Hdf5File file;
  file.group("/run");
  file.data<double>("/run/data", {4, 3},
                    {0.0, 1.0, 10.0, 0.5, 2.0, 20.0, 1.0, 3.0, 30.0, 1.5, 4.0, 40.0},
                    H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
  file.text_list("/run/channel_names", {"time", "force", "slip"});
  file.text_list("/run/units", {"ms", "N", "um"});
  file.text_list("/notes", {"first", "second"});
  const Record record = imported(file.bytes(), {}, ".h5");
  EXPECT_THAT(names_and_units(record),
              ElementsAre("/run/data.time [ms]", "/run/data.force [N]", "/run/data.slip [um]"));
  EXPECT_DOUBLE_EQ(record.channels[1].clock.interval, 5e-4);
  EXPECT_THAT(record.warnings, ElementsAre("not read: '/notes' (text)"));
}

}  // namespace
}  // namespace impactrig::acquisition
