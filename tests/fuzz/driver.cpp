/// @file
/// Runs a fuzz target without libFuzzer: files and folders are replayed; with --seconds N, mutations of them follow.
///
///     fuzz_pairs [--seconds N] [--seed S] [--keep FILE] FILE|FOLDER...
///
/// Before each mutated input it is written to the file of --keep, so that what ends the program stands there.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A few bytes changed, inserted, left out, repeated, or taken from another input.
Bytes mutated(const std::vector<Bytes>& pool, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % std::max<std::size_t>(n, 1)); };
  Bytes bytes = pool.empty() || below(8) == 0 ? Bytes(8 + below(120)) : pool[below(pool.size())];
  if (pool.empty() || below(8) == 0) {
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
  }
  for (std::size_t k = 1 + below(6); k > 0; --k) {
    const std::size_t at = below(bytes.size() + 1);
    switch (below(5)) {
      case 0:
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), static_cast<std::uint8_t>(random()));
        break;
      case 1:
        if (at < bytes.size()) bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
        break;
      case 2:
        if (!pool.empty()) {
          const Bytes& other = pool[below(pool.size())];
          const std::size_t from = below(other.size());
          const std::size_t count = std::min(below(16), other.size() - from);
          bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                       other.begin() + static_cast<std::ptrdiff_t>(from),
                       other.begin() + static_cast<std::ptrdiff_t>(from + count));
        }
        break;
      default:
        if (at < bytes.size()) {
          bytes[at] = static_cast<std::uint8_t>(below(2) == 0 ? random() : bytes[at] + below(5) - 2);
        }
    }
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  double seconds = 0;
  std::uint64_t seed = 1;
  std::string keep;
  std::vector<Bytes> pool;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--seconds" && i + 1 < argc) {
      seconds = std::strtod(argv[++i], nullptr);
    } else if (word == "--seed" && i + 1 < argc) {
      seed = std::strtoull(argv[++i], nullptr, 10);
    } else if (word == "--keep" && i + 1 < argc) {
      keep = argv[++i];
    } else if (std::filesystem::is_directory(word)) {
      std::vector<std::filesystem::path> files;
      for (const auto& entry : std::filesystem::directory_iterator(word)) files.push_back(entry.path());
      std::sort(files.begin(), files.end());
      for (const auto& file : files) pool.push_back(read(file));
    } else if (std::filesystem::exists(word)) {
      pool.push_back(read(word));
    } else {
      std::fprintf(stderr, "%s: no such file\n", word.c_str());
      return 2;
    }
  }
  for (const Bytes& bytes : pool) (void)LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  std::mt19937_64 random(seed);
  std::int64_t runs = 0;
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds) {
    const Bytes bytes = mutated(pool, random);
    if (!keep.empty()) {
      std::ofstream(keep, std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    (void)LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    ++runs;
  }
  std::printf("%zu inputs replayed, %lld mutations, seed %llu\n", pool.size(), static_cast<long long>(runs),
              static_cast<unsigned long long>(seed));
  return 0;
}
