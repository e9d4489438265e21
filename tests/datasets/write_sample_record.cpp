// SPDX-License-Identifier: BSD-3-Clause
// write_sample_record FILE: the record that read_with_h5py.py expects.
#include "datasets/store.hpp"
#include "tests/datasets/sample_record.hpp"

int main(int count, char** arguments) {
  if (count != 2) return 2;
  impactrig::datasets::write_record(tests::sample_record(), arguments[1]);
  return 0;
}
