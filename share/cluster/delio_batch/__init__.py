"""What delio-batch is made of.

inputs        what is asked for: lists of inputs, their names and truths
batch         the folder of a batch: its frozen list, where everything is, who may write
task          one drive with one variant, from scratch folder to its place
slurm, local  the two engines that hand tasks out
collect       the collecting job: table, failures, page, sweep charts
status        how far it is
"""
