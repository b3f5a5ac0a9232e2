#include "apps/tools/sweep/sweep_command.hpp"

#include <array>

namespace wholehand {

std::optional<SweepShare> shareOfRank() {
  constexpr std::array kNames{std::array{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},
                              std::array{"PMI_RANK", "PMI_SIZE"}};  // Open MPI, MPICH
  for (const auto& [rank_name, size_name] : kNames) {
    const auto rank = environmentNumber(rank_name), size = environmentNumber(size_name);
    if (rank && size && *size > 0 && *rank < *size) return SweepShare{*rank, *size};
  }
  return std::nullopt;
}

}  // namespace wholehand
