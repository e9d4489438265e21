// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hdf5.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <utility>

namespace impactrig::datasets {

/// Owns one HDF5 identifier: Hdf5Handle file(H5Fopen(...), H5Fclose).
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Hdf5Handle(hid_t id, Close closer) : id_(id), close_(closer) {}

  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)),
        close_(other.close_) {}

  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }

  ~Hdf5Handle() { close(); }

  hid_t id() const { return id_; }

  bool valid() const { return id_ >= 0; }

  /// False when HDF5 could not finish, which for a file means that its last bytes are not on disk.
  bool close() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 || close_(id) >= 0;
  }

 private:
  hid_t id_;
  Close close_;
};

/// While it lives: one thread at a time in our HDF5 code, as the library may be built without
/// thread safety, and no error stacks on stderr, as every failure is told by an exception.
class Hdf5Session {
 public:
  Hdf5Session() : lock_(mutex()) {
    [[maybe_unused]] static const bool once = without_cleaning_at_exit();
    H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }

  Hdf5Session(const Hdf5Session&) = delete;
  Hdf5Session& operator=(const Hdf5Session&) = delete;

  ~Hdf5Session() { H5Eset_auto2(H5E_DEFAULT, print_, print_data_); }

 private:
  static std::mutex& mutex() {
    static std::mutex only;
    return only;
  }

  /// After a damaged file, or one that could not be closed, HDF5 1.10.8 crashes or complains when it
  /// frees what is left at the end of the program. What we open we close, so it need not.
  static bool without_cleaning_at_exit() {
    H5dont_atexit();
    return H5open() >= 0;
  }

  std::lock_guard<std::mutex> lock_;
  H5E_auto2_t print_ = nullptr;
  void* print_data_ = nullptr;
};

inline hid_t hdf5_memory_type(double) {
  return H5T_NATIVE_DOUBLE;
}

inline hid_t hdf5_memory_type(float) {
  return H5T_NATIVE_FLOAT;
}

inline hid_t hdf5_memory_type(std::int16_t) {
  return H5T_NATIVE_INT16;
}

inline hid_t hdf5_memory_type(std::int32_t) {
  return H5T_NATIVE_INT32;
}

inline hid_t hdf5_memory_type(std::int64_t) {
  return H5T_NATIVE_INT64;
}

inline hid_t hdf5_memory_type(std::uint64_t) {
  return H5T_NATIVE_UINT64;
}

inline hid_t hdf5_memory_type(std::uint8_t) {
  return H5T_NATIVE_UINT8;
}

/// The same in the file: little endian whatever the machine.
inline hid_t hdf5_file_type(double) {
  return H5T_IEEE_F64LE;
}

inline hid_t hdf5_file_type(float) {
  return H5T_IEEE_F32LE;
}

inline hid_t hdf5_file_type(std::int16_t) {
  return H5T_STD_I16LE;
}

inline hid_t hdf5_file_type(std::int32_t) {
  return H5T_STD_I32LE;
}

inline hid_t hdf5_file_type(std::int64_t) {
  return H5T_STD_I64LE;
}

inline hid_t hdf5_file_type(std::uint64_t) {
  return H5T_STD_U64LE;
}

inline hid_t hdf5_file_type(std::uint8_t) {
  return H5T_STD_U8LE;
}

/// UTF-8 text of a fixed number of bytes, filled up with NUL. HDF5 keeps text of variable length in
/// heaps without a checksum, and one wrong byte in them makes the library itself write outside its
/// memory (seen with 1.10.8).
inline Hdf5Handle hdf5_text_type(std::size_t width) {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), std::max<std::size_t>(width, 1));
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  return type;
}

}  // namespace impactrig::datasets
