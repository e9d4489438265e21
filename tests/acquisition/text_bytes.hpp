// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace impactrig::acquisition::tests {

/// Small text recordings, one a dialect.
/// So many that the line is a channel.
inline std::string numbers_in_a_line(std::string line) {
  for (int k = 0; k < 70; ++k) line += (k > 0 ? "," : "") + std::to_string(0.5 * k);
  return line + "\n";
}

inline std::vector<std::string> csv_seeds() {
  return {
      "Time [s],Force [N]\n0,1\n1e-6,2.5\n2e-6,-3\n3e-6,\n",
      "Zeit;Kraft\ns;N\n0,0;1,5\n0,001;2,5\n0,002;nan\n",
      "# time\tacceleration\n0.0 1.0\n0.1   2.0\n0.2\t3.0\n",
      "X,CH1,Start,Increment\nSequence,Volt,-1e-3,1e-6\n0,1.2,\n1,1.4,\n2,\"1.6\",\n",
      "Date;Time;F [N]\n31.12.2024;23:59:59,5;1,5\n01.01.2025;00:00:00,0;2,5\n",
      "Stamp State F\n3/1/2024 11:59:59.9 PM 1\n3/2/2024 12:00:00.1 AM 2\n",
      "Time,F\n2024-03-01T12:00:00Z,1\n2024-03-01T14:00:00+02:00,2\n01-Mar-2024 12:00:01,3\n",
      "Record Length,5,,-0.5,1,\n,,,0.0,2,\nSource,CH1,,0.5,3,\n,,,1.0,4,\n,,,1.5,5,\n",
      "\"TraceName\",\"F\",\"v\"\n\"VUnit\",\"N\",\"V\"\n\"HResolution\",1e-3,1e-3\n\"HOffset\",-1,"
      "-1\n"
      "\"Time\",\"10:11:12\",\"10:11:12\"\n\n,1.5,4.0,\n,2.5,3.0,\n",
      "# 1: time [ms]\n# 2: force [kN]\n0.0 1.5\n0.1 2.5\n",
      "Zeit  1\tKraft\ns\tN\nM 0\tSN 1\n----\t----\n0,0\t+  1,5\n0,5\t-  2,5\n",
      "Time [ms],1,2\n0.0,5.5,6\n0.1,4.5,3\n",
      "channel names: \na\tb\nstart times: \n3/15/2014 10:11:12.5\t3/15/2014 10:11:12.5\ndt: \n"
      "0.000100\t0.000100\ndata: \n1.5\t2.5\n0.5\t3.5\n",
      "Channel :,CH1\nTime interval :,0.08uS\n\nindex,CH1_Voltage(mV)\n0,1.5\n1,2.5\n",
      "Vendor;GRAPHTEC Corporation\nAMP settings\nCH;Signal name;Span;;Unit\nCH1;a;1;-1;[N]\nData\n"
      "Number;Date;Time;us;CH1;Alarm\n1;2026/06/01;17:01:39;999800;+1,5;LL\n"
      "2;2026/06/01;17:01:40;0;+++++;LL\n",
      "Record Length,5,,-0.5,1,,Record Length,5,,-0.2,3,\nSource,CH1,,0.0,2,,Source,CH2,,0.3,4,\n"
      ",,,0.5,3,,,,,0.8,5,\n,,,1.0,4,,,,,1.3,6,\n",
      "# two\n" + numbers_in_a_line("t,s,") + numbers_in_a_line("F,N,"),
      numbers_in_a_line(""),
      "\"t [s];F [N]\"\n\"0,0;1.234,5\"\n\"0,1;2,5\"\n",
      "State,t [s],F [N]\nOK,0.0,\"1,234.5\"\nOK,0.1,1'234\n",
      "Year;Month;Day;Hour;Minute;Second;ms;F\n2024;2;29;23;59;59;500;1,5\n2024;3;1;0;0;0;0;2,5\n",
      "Ch1: Force / N\nCh2: Vel / m/s\nRate,50000,Hz\n0.2\t2.5\n0.1\t3.5\n0.3\t4.5\n",
      "Time,F\n-1 days +23:59:59.998,1\n-00:00:00.001,2\n00:00:00,3\n",
      "Model,MSO64\nSample Interval,1e-9\nVertical Units,V\n\nLabels,,\nTIME,CH1\n0,1\n1e-9,2\n",
  };
}

inline std::vector<std::string> polytec_seeds() {
  return {
      "Source File Name:\ta.pvd\r\nComponent:\tRoot\r\n\r\nSignal:\tTime - Vib Velocity - "
      "Samples\r\n\r\nTime\tVelocity\r\n[ s ]\t[ m/s ]\r\n0\t0.1\r\n1e-6\t0.2\r\n",
  };
}

/// A dataset 58 with the given first line of record 7 and numbers.
inline std::string uff58_dataset(const std::string& identifier, const std::string& form,
                                 const std::string& data) {
  return "    -1\n" + identifier +
         "\nForce\nNONE\n01-Jan-20 10:00:00\nNONE\nNONE\n"
         "    1         0    0         0       NONE         1   3       NONE         1   3\n" +
         form +
         "\n        17    0    0    0 Time                 s                   \n"
         "        13    0    0    0 Force                N                   \n"
         "         0    0    0    0 NONE                 NONE                \n"
         "         0    0    0    0 NONE                 NONE                \n" +
         data + "    -1\n";
}

inline std::vector<std::string> uff58_seeds() {
  return {
      "    -1\n   151\nmodel\nNONE\nprogram\n    -1\n" +
          uff58_dataset("    58",
                        "         2         4         1  0.00000E+00  1.00000E-06  0.00000E+00",
                        "  1.00000E+00  2.00000E+00 -3.00000E+00  4.00000E+00\n"),
      uff58_dataset("    58",
                    "         4         2         0  0.00000E+00  0.00000E+00  0.00000E+00",
                    "  0.00000E+00  1.00000000000E+00  1.00000E-06  2.00000000000E+00\n"),
      uff58_dataset("    58",
                    "         5         2         1  0.00000E+00  1.00000E+00  0.00000E+00",
                    "  1.00000E+00  2.00000E+00 -3.00000E+00  4.00000D+00\n"),
  };
}

inline std::vector<std::string> uff58b_seeds() {
  const std::string eight("\0\0\x80\x3f\0\0\0\x40", 8);
  return {
      uff58_dataset(
          "    58b     1     2          11           8     0     0           0           0",
          "         2         2         1  0.00000E+00  1.00000E-06  0.00000E+00", eight),
      uff58_dataset(
          "    58b     2     2          11          16     0     0           0           0",
          "         4         2         1  0.00000E+00  1.00000E-06  0.00000E+00", eight + eight),
  };
}

}  // namespace impactrig::acquisition::tests
