#include "tests/simulation/tally.h"

#include <algorithm>

namespace depthfarm::simulation {

void Tally::Add(const Tally& other) {
  runs += other.runs;
  attempts += other.attempts;
  messages += other.messages;
  messages_lost += other.messages_lost;
  worker_crashes += other.worker_crashes;
  deaths_told += other.deaths_told;
  standstills += other.standstills;
  cuts += other.cuts;
  store_losses += other.store_losses;
  coordinator_crashes += other.coordinator_crashes;
  torn_writes += other.torn_writes;
  late_results += other.late_results;
  asked_back += other.asked_back;
  given_back += other.given_back;
  duplicates += other.duplicates;
  duplicates_won += other.duplicates_won;
  jobs_done += other.jobs_done;
  jobs_ended_otherwise += other.jobs_ended_otherwise;
  hours += other.hours;
  longest_end = std::max(longest_end, other.longest_end);
}

}  // namespace depthfarm::simulation
