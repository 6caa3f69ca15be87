"""Averages of the paper's tables (Mieloch, Stankiewicz, Domański): what ours are put beside."""

# Table II: mean PSNR of virtual views over the eight sequences, dB.
DERS_PSNR = 26.21
PROPOSAL_PSNR = 28.84
PROPOSAL_GAIN = 2.63
PROPOSAL_TIME_RATIO = 0.27  # of DERS's time, mean of the ratios

# Table IV: segments a view -> dB.
SEGMENTS = {1000: 26.21, 5000: 27.55, 10000: 27.94, 25000: 28.25, 50000: 28.59, 100000: 28.84, 150000: 28.94}

# Table V: views -> dB.
VIEWS = {3: 28.39, 4: 28.66, 5: 28.73, 6: 28.77, 7: 28.79, 8: 28.82}

# Table VI: (partition, parts) -> dB.
PARTITION = {("", 1): 28.74, ("interleaved", 2): 28.68, ("interleaved", 4): 28.60, ("interleaved", 6): 28.58,
             ("blocks", 2): 28.68, ("blocks", 4): 28.63, ("blocks", 6): 28.62}

# Table VII: P frames between I frames -> dB.
P_FRAMES = {0: 28.84, 4: 28.80, 9: 28.73, 24: 28.67, 49: 28.59}

# Table III: P frames -> bit rate of the virtual views against none, percent.
P_FRAMES_RATE = {4: -19.2, 9: -26.7, 24: -29.7, 49: -32.0}
