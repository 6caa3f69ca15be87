#include "coordinator/metrics/farm_metrics.h"

#include <prometheus/metric_family.h>
#include <prometheus/text_serializer.h>

#include <vector>

namespace depthfarm {
namespace {

using Labels = std::vector<prometheus::ClientMetric::Label>;

class Families {
 public:
  void Gauge(const std::string& name, const std::string& help, double value, const Labels& labels = {}) {
    prometheus::ClientMetric& metric = Add(name, help, prometheus::MetricType::Gauge, labels);
    metric.gauge.value = value;
  }
  void Counter(const std::string& name, const std::string& help, double value, const Labels& labels = {}) {
    prometheus::ClientMetric& metric = Add(name, help, prometheus::MetricType::Counter, labels);
    metric.counter.value = value;
  }
  [[nodiscard]] const std::vector<prometheus::MetricFamily>& all() const { return families_; }

 private:
  // Of one name all come in a row.
  prometheus::ClientMetric& Add(const std::string& name, const std::string& help, prometheus::MetricType type,
                                const Labels& labels) {
    const std::string full_name = "depthfarm_" + name;
    if (families_.empty() || families_.back().name != full_name) {
      families_.push_back({full_name, help, type, {}});
    }
    families_.back().metric.emplace_back();
    families_.back().metric.back().label = labels;
    return families_.back().metric.back();
  }

  std::vector<prometheus::MetricFamily> families_;
};

double Number(std::uint64_t value) { return static_cast<double>(value); }

}  // namespace

std::string FormatMetrics(const FarmMetrics& metrics) {
  Families families;
  families.Gauge("info", "1; versions are in the labels", 1,
                 {{"version", metrics.version},
                  {"algorithm", std::to_string(metrics.algorithm_version)},
                  {"protocol", std::to_string(metrics.protocol_version)}});
  families.Gauge("jobs_running", "Jobs that did not end yet", Number(metrics.jobs_running));
  for (const auto& [state, jobs] : metrics.jobs_ended) {
    families.Counter("jobs_ended_total", "Jobs by how they ended", Number(jobs), {{"state", state}});
  }
  families.Gauge("tasks_leased", "Tasks that workers have", Number(metrics.tasks_leased));
  families.Gauge("tasks_ready", "Tasks that a free slot would get", Number(metrics.tasks_ready));
  families.Gauge("gops_unopened", "Groups of pictures to come", Number(metrics.gops_unopened));
  families.Gauge("wanted_slots", "Slots that would not be idle: what to scale workers by",
                 Number(metrics.tasks_leased + metrics.tasks_ready + metrics.gops_unopened));
  families.Gauge("workers", "Workers of the farm", Number(metrics.workers));
  families.Gauge("workers_draining", "Workers that get no more tasks", Number(metrics.workers_draining));
  families.Gauge("slots", "Tasks that workers compute at a time", Number(metrics.slots));
  families.Gauge("artifacts", "Artifacts that workers hold, copies included", Number(metrics.artifacts));
  families.Gauge("artifact_bytes", "Their size", Number(metrics.artifact_bytes));
  for (const auto& [kind_and_outcome, attempts] : metrics.attempts) {
    families.Counter("attempts_total", "Attempts of tasks by how they ended", Number(attempts),
                     {{"kind", kind_and_outcome.first}, {"outcome", kind_and_outcome.second}});
  }
  for (const auto& [kind, seconds] : metrics.cpu_seconds) {
    families.Counter("task_cpu_seconds_total", "CPU time of tasks that made a result", seconds, {{"kind", kind}});
  }
  families.Counter("late_results_total", "Results of leases that had ended before", Number(metrics.late_results));
  for (const auto& [what, times] : metrics.refused) {
    families.Counter("refused_total", "Handshakes and messages that were refused", Number(times), {{"what", what}});
  }
  return prometheus::TextSerializer().Serialize(families.all());
}

}  // namespace depthfarm
