#include "mesh/io/detail/base64.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace umtet::detail {
namespace {

std::string encoded(const std::vector<unsigned char>& bytes) {
  std::string text(base64_length(bytes.size()), ' ');
  encode_base64(bytes, text.data());
  return text;
}

std::string encoded(const std::string& bytes) {
  return encoded(std::vector<unsigned char>(bytes.begin(), bytes.end()));
}

// RFC 4648, Section 10.
TEST(Base64, IsThatOfTheStandard) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

// Six bits at a time, from the highest bit of the first byte on.
TEST(Base64, HasSixBitsADigit) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::mt19937 random(2);
  for (std::size_t n = 1; n < 3000; n += 1 + n / 7) {
    std::vector<unsigned char> bytes(n);
    for (unsigned char& b : bytes) b = static_cast<unsigned char>(random());
    std::string expected;
    for (std::size_t first = 0; first < 8 * n; first += 6) {
      unsigned value = 0;
      for (std::size_t bit = first; bit < first + 6; ++bit)
        value = 2 * value + (bit < 8 * n ? bytes[bit / 8] >> (7 - bit % 8) & 1U : 0U);
      expected += digits[value];
    }
    expected.resize(base64_length(n), '=');
    EXPECT_EQ(encoded(bytes), expected);
  }
}

}  // namespace
}  // namespace umtet::detail
